// rigid3d compared with Bullet 3.24 (double): free fall, friction, surfaces, commands, to the error of
// Bullet's first-order steps. Joints and what rests: rigid3d_bullet_joints_test.cc,
// rigid3d_bullet_rest_test.cc.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/rigid3d_state.h"
#include "tests/support/runs/engine_run.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

constexpr double kGravity = 9.81;

TEST(Bullet, FreeFallDiffersByTheFirstOrderErrorOfItsSteps) {
  // Semi-implicit Euler falls g t h / 2 farther than the parabola; ours follows the parabola.
  Rigid3dDef d;
  d.bodies = {ball(0.5, {0, 10, 0})};
  for (const double h : {1.0 / 60, 1.0 / 120}) {
    EngineRun a = ours(d, h), b = theirs(d, h);
    a.seconds(1), b.seconds(1);
    EXPECT_NEAR(a.x(0).y - b.x(0).y, kGravity * h / 2, 1e-9);
    EXPECT_NEAR(a.v(0).y, b.v(0).y, 1e-9);
  }
  // Control: nine tenths of gravity are half a metre off.
  Rigid3dDef wrong = d;
  std::get<SphereBodyDef>(wrong.bodies[0]).gravity_scale = 0.9;
  EngineRun a = ours(d), b = theirs(wrong);
  a.seconds(1), b.seconds(1);
  EXPECT_GT(std::abs(a.x(0).y - b.x(0).y - kGravity / 120), 0.4);
}

TEST(Bullet, ABoxSlidesAsFar) {
  const auto distance = [](auto engine, double friction) {
    Rigid3dDef d;
    BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
    b.velocity = {3, 0, 0};
    d.bodies = {ground(), b}, d.friction = friction;
    EngineRun r = engine(d);
    r.seconds(2);
    EXPECT_LT(norm(r.v(1)), 1e-3);
    return r.x(1).x;
  };
  const auto own = [](const Rigid3dDef& d) { return ours(d); };
  const auto other = [](const Rigid3dDef& d) { return theirs(d); };
  // v^2 / (2 mu g), to within v h / 2 of the first step.
  const double expected = 9 / (2 * 0.5 * kGravity), tolerance = 3.0 / 120 + 0.005;
  EXPECT_NEAR(distance(own, 0.5), expected, tolerance);
  EXPECT_NEAR(distance(other, 0.5), expected, tolerance);
  EXPECT_GT(std::abs(distance(other, 0.6) - expected), tolerance);
}

TEST(Bullet, SurfacesMixByTheScenesRules) {
  // Restitution: the larger value counts. A ball with 0.8 on a floor with 0 bounces to 0.64 of its height.
  const auto second_height = [](EngineRun r) {
    double top = 0;
    r.seconds(0.7);
    for (int k = 0; k < 60; ++k) r.run(1), top = std::max(top, r.x(1).y);
    return top;
  };
  Rigid3dDef d;
  SphereBodyDef b = ball(0.1, {0, 1.1, 0});
  b.restitution = 0.8;
  d.bodies = {ground(), b};
  // The time of the impact is known to within a step, that is v h = 4.4 m/s / 240 of height either way, and
  // Bullet's contacts begin 2 cm before the bodies touch.
  EXPECT_NEAR(second_height(ours(d, 1.0 / 240)), 0.74, 0.03);
  EXPECT_NEAR(second_height(theirs(d, 1.0 / 240)), 0.74, 0.03 + 0.02);
  std::get<SphereBodyDef>(d.bodies[1]).restitution = 0.6;
  EXPECT_LT(second_height(theirs(d, 1.0 / 240)), 0.6);
}

TEST(Bullet, KinematicBodiesPushAndSensorsDoNot) {
  Rigid3dDef d;
  BoxBodyDef pusher = box({0.2, 0.5, 1}, {-2, 0.5, 0}), ghost = box({0.5, 0.5, 0.5}, {3, 0.5, 0});
  pusher.motion = BodyDef::Motion::kinematic, pusher.velocity = {1, 0, 0};
  ghost.sensor = true, ghost.motion = BodyDef::Motion::fixed;
  d.bodies = {ground(), pusher, box({0.5, 0.5, 0.5}, {0, 0.5, 0}), ghost};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(4), b.seconds(4);
  EXPECT_NEAR(b.x(1).x, 2, 1e-9);
  EXPECT_NEAR(b.x(2).x, 2.7, 0.02);  // in front of the pusher, inside the sensor
  EXPECT_NEAR(a.x(2).x, b.x(2).x, 0.02);
  EXPECT_GE(b.observed("sensed"), 1);
}

TEST(Bullet, CommandsActAndARebuiltWorldGoesOn) {
  Rigid3dDef d;
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->count = {1, 4, 1};
  SphereBodyDef free = ball(0.2, {5, 60, 0});
  free.mass = 2;
  d.bodies = {ground(), b, free};
  EngineRun r = theirs(d);
  r.seconds(1);
  // The same state in a fresh workspace: free flight continues to the bit, and what stands keeps standing.
  EngineRun copy = theirs(d);
  copy.state = State::deserialize(r.state.serialize()), copy.steps = r.steps;
  r.run(20), copy.run(20);
  EXPECT_LT(norm(r.x(5) - copy.x(5)), 1e-12);
  for (size_t i = 1; i < 5;
       ++i)  // Without the warm-start impulses every contact gives way by a millimetre or two, once.
    EXPECT_LT(norm(r.x(i) - copy.x(i)), 2.5e-3 * static_cast<double>(i)) << i;

  Command c;
  c.kind = CommandKind::impulse, c.index = 5, c.vector = {4, 0, 0};
  const double before = r.v(5).x;
  r.system->apply(r.state, c);
  EXPECT_NEAR(r.v(5).x - before, 2, 1e-12);
  c.kind = CommandKind::push, c.vector = {0, 0, 6}, c.duration = 0.5;
  r.system->apply(r.state, c);
  const double z = r.v(5).z;
  r.run(3);
  EXPECT_NEAR(r.v(5).z - z, 3 * 3.0 / 60, 1e-9);
  c.kind = CommandKind::spawn, c.vector = {0, 20, 0};
  r.system->apply(r.state, c);
  r.run(1);
  EXPECT_EQ(r.count(), 7u);
  EXPECT_LT(r.x(6).y, 20);
  c.kind = CommandKind::remove, c.index = 1;
  r.system->apply(r.state, c);
  r.seconds(1);
  EXPECT_EQ(r.count(), 6u);
  EXPECT_LT(r.x(1).y, 0.6);  // the box above fell onto the ground
}

TEST(Bullet, RefusesWhatItHasNoEquivalentOf) {
  Rigid3dDef d;
  MeshBodyDef mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  d.bodies = {ground(), mesh};
  EXPECT_NO_THROW(ours(d));
  try {
    theirs(d);
    FAIL() << "a dynamic mesh was taken";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/bodies/1/motion");
  }
}

}  // namespace
}  // namespace truestep::testing
