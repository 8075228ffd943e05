// One scene with every feature: the same bits for any number of threads, without the workspace, and after a
// snapshot.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

ParticlesDef everything(const char* integrator) {
  ParticlesDef d;
  FillDef f;
  f.count = 3000, f.center = {0, 1, 0}, f.speed_spread = 1;
  d.fill = {f};
  EmitterDef e;
  e.rate = 3000, e.cone = 0.4, e.speed = 4, e.lifetime = 0.3, e.lifetime_spread = 0.1, e.speed_spread = 1;
  d.emitters = {e};
  d.linear_drag = 0.1, d.quadratic_drag = 0.02, d.wind = {0.3, 0, 0};
  d.attractors = {{{0, 2, 0}, 3, 0.2}};
  d.pair_forces = {SoftRepulsionDef{20, 0.08}, ViscosityDef{0.05, 0.1}};
  for (int i = 0; i < 100; ++i) {
    PairSpringDef s;
    s.a = i, s.b = i + 1;
    d.springs.push_back(s);
  }
  d.charge = 0.1, d.magnetic_field = {0, 0, 1};
  d.expression = ExpressionDef{"0.1 * sin(3 * x + t)", "0", "-0.2 * exp(-z^2)", {}};
  PlaneColliderDef plane;
  SphereColliderDef ball;
  ball.center = {0, 0.6, 0}, ball.radius = 0.3, ball.motion = MotionDef{{}, {0.5, 0, 0}, {0, 1, 0}, 1, 0};
  d.colliders = {plane, ball};
  d.kill_boxes = {{{0, 0, 0}, {3, 3, 3}, KillBoxDef::Where::outside}};
  d.integrator = integrator;
  return d;
}

class ParticlesDeterminism : public ::testing::TestWithParam<const char*> {};

TEST_P(ParticlesDeterminism, ThreadsAndWorkspaceDoNotMatter) {
  uint64_t reference = 0;
  for (const int threads : {1, 2, 4}) {
    ParticlesRun r(everything(GetParam()), 1.0 / 120, threads);
    for (int k = 0; k < 60; ++k) {
      r.run(1);
      if (threads == 2) r.workspace.clear();
    }
    if (threads == 1) reference = r.state.hash();
    EXPECT_EQ(r.state.hash(), reference) << threads;
  }
  ParticlesRun control(everything(GetParam()), 1.0 / 120, 1, 8);  // another seed
  control.run(60);
  EXPECT_NE(control.state.hash(), reference);
}

TEST_P(ParticlesDeterminism, ASnapshotContinuesTheTrajectory) {
  ParticlesRun a(everything(GetParam()), 1.0 / 120);
  Command drag;
  drag.kind = CommandKind::drag, drag.index = 5, drag.vector = {0, 3, 0};
  Command push;
  push.kind = CommandKind::push, push.index = 9, push.vector = {0, 3, 0}, push.duration = 0.2;
  a.run(10);
  a.system->apply(a.state, drag);
  a.system->apply(a.state, push);
  a.run(10);
  ParticlesRun b(everything(GetParam()), 1.0 / 120);
  b.state = State::deserialize(a.state.serialize());
  b.steps = a.steps;
  for (int k = 0; k < 40; ++k) {
    a.run(1), b.run(1);
    ASSERT_EQ(a.state, b.state) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, ParticlesDeterminism, ::testing::Values("leapfrog", "verlet", "midpoint"));

TEST(ParticlesCommands, ChangeWhatTheySay) {
  ParticlesDef d;
  d.positions = {{0, 0, 0}, {1, 0, 0}};
  d.gravity = Vec3{};
  d.colliders = {PlaneColliderDef{}};
  d.max_particles = 3;
  ParticlesRun r(d);
  Command c;
  c.kind = CommandKind::impulse, c.index = 1, c.vector = {0, 2, 0};
  r.system->apply(r.state, c);
  EXPECT_EQ(r.v(1).y, 2);
  c.kind = CommandKind::push, c.vector = {3, 0, 0}, c.duration = 0;
  r.system->apply(r.state, c);
  r.run(2);
  EXPECT_NEAR(r.v(1).x, 3 * r.h, 1e-15);  // one step
  c.kind = CommandKind::spawn, c.vector = {5, 5, 5}, c.velocity = {1, 0, 0};
  r.system->apply(r.state, c);
  EXPECT_EQ(r.count(), 3u);
  EXPECT_THROW(r.system->apply(r.state, c), Error);  // full
  c.kind = CommandKind::remove, c.index = 0;
  r.system->apply(r.state, c);
  EXPECT_EQ(r.count(), 2u);
  EXPECT_EQ(r.v(1).x, 1);
  c.kind = CommandKind::set_parameter, c.name = "gravity", c.vector = {0, -1, 0};
  r.system->apply(r.state, c);
  c.name = "plane0.restitution", c.value = 0.25;
  r.system->apply(r.state, c);
  EXPECT_EQ(r.state.f64(particles::columns::surfaces)[0], 0.25);
  c.value = 2;
  EXPECT_THROW(r.system->apply(r.state, c), Error);
  c.name = "nonsense";
  EXPECT_THROW(r.system->apply(r.state, c), Error);
  c.kind = CommandKind::pin;
  EXPECT_THROW(r.system->apply(r.state, c), Error);
  c.kind = CommandKind::drag, c.index = 0, c.vector = {2, 2, 2}, c.value = 0;
  r.system->apply(r.state, c);
  r.run(240 * 5);
  EXPECT_LT(norm(r.x(0) - Vec3{2, 2 - 0.01, 2}), 1e-6);  // gravity 1 against 100 m: sags by 1 cm
  c.kind = CommandKind::release, c.index = -1;
  r.system->apply(r.state, c);
  EXPECT_EQ(r.state.rows(particles::columns::drag_id), 0u);
  c.index = 77;
  EXPECT_THROW(r.system->apply(r.state, c), Error);
}

}  // namespace
}  // namespace truestep
