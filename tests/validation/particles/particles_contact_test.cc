// The system "particles" against solids, through every explicit method.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

/// Every explicit method that serves these scenes.
std::vector<const Integrator*> methods() {
  std::vector<const Integrator*> out;
  for (const Integrator& m : integrators()) {
    if (m.kind == Integrator::Kind::explicit_) out.push_back(&m);
  }
  return out;
}

PlaneColliderDef ground(double e, double mu) {
  PlaneColliderDef p;
  p.restitution = e, p.friction = mu;
  return p;
}

TEST(ParticlesContact, BouncesRiseToESquared) {
  for (const Integrator* m : methods()) {
    ParticlesDef d;
    d.positions = {{0, 1, 0}};
    d.colliders = {ground(0.7, 0)};
    d.integrator = std::string(m->name);
    ParticlesRun r(d, 1.0 / 480);
    double top = 0;
    bool bounced = false;
    for (int k = 0; k < 480; ++k) {
      r.run(1);
      bounced |= r.v(0).y > 0;
      if (bounced) top = std::max(top, r.x(0).y);
      if (bounced && r.v(0).y < 0) break;
    }
    // Sampling at 1/480 s misses the peak by at most g h^2 / 8; first-order methods start with h v = g h^2 /
    // 2 and drift by g h per second on the way.
    EXPECT_NEAR(top, 0.49, m->order == 1 ? 0.03 : 2e-5) << m->name;
    EXPECT_GT(std::fabs(top - 0.8 * 0.8), 0.1);  // control: another restitution
  }
}

TEST(ParticlesContact, RestsForEverUnderEveryMethod) {
  for (const Integrator* m : methods()) {
    ParticlesDef d;
    d.positions = {{0, 0.3, 0}, {0.5, 0.2, 0}};
    d.velocities = {{0.2, 0, 0.1}, {0, 0, 0}};
    d.radius = 0.05;
    d.colliders = {ground(0.5, 0.6)};
    d.integrator = std::string(m->name);
    ParticlesRun r(d);
    r.run(240 * 4);
    const Vec3 x = r.x(0);
    EXPECT_NEAR(x.y, 0.05, 1e-8) << m->name;
    r.run(240);
    EXPECT_EQ(r.x(0), x) << m->name;
    EXPECT_EQ(r.observed("energy.kinetic"), 0) << m->name;
  }
}

TEST(ParticlesContact, SlidesDownTheInclineAsInTheReferenceCase) {
  // contact.incline: 30 deg, mu 0.3: 1.17814 m in the first second; mu 0.6: no creep.
  for (const Integrator* m : methods()) {
    for (const double mu : {0.3, 0.6}) {
      ParticlesDef d;
      PlaneColliderDef p = ground(0, mu);
      p.normal = {0.5, std::sqrt(0.75), 0};
      d.colliders = {p};
      d.positions = {{0, 0, 0}};
      d.integrator = std::string(m->name);
      ParticlesRun r(d);
      r.run(240);
      const double slid = norm(r.x(0));
      if (mu > 0.5) {
        EXPECT_LT(slid, 2e-9) << m->name;  // the slop that keeps it off the plane
      } else {
        // The case's tolerance, 1e-3, for order 2; first order adds a h / 2 to the distance.
        EXPECT_NEAR(slid, 1.178143618331198531, m->order == 1 ? 0.01 : 1e-3 * 1.178) << m->name;
      }
    }
  }
}

TEST(ParticlesContact, ABoxHoldsTwoThousandParticles) {
  ParticlesDef d;
  FillDef f;
  f.count = 2000, f.arrangement = FillDef::Arrangement::random, f.speed_spread = 30;
  f.half_extents = {0.9, 0.9, 0.9};
  d.fill = {f};
  BoxColliderDef box;
  box.container = true, box.half_extents = {1, 1, 1}, box.restitution = 0.9, box.friction = 0.1;
  box.angle = 0.5, box.axis = {1, 2, 3};
  SphereColliderDef ball;
  ball.radius = 0.3;
  ball.motion = MotionDef{{}, {0.5, 0, 0}, {0, 5, 0}, 1.5, 0};
  CapsuleColliderDef bar;
  bar.from = {-0.5, -0.6, 0}, bar.to = {0.5, -0.6, 0}, bar.radius = 0.1;
  d.colliders = {box, ball, bar};
  ParticlesRun r(d, 1.0 / 120);
  const ColliderSet set = build_colliders({box});
  double worst = 1;
  for (int k = 0; k < 240; ++k) {
    r.run(1);
    for (size_t i = 0; i < r.count(); ++i) worst = std::min(worst, set.clearance(r.x(i), r.t()));
  }
  EXPECT_GE(worst, -1e-12);
}

TEST(ParticlesContact, BirthsDoNotPassAWallInTheirFirstStep) {
  // Born 1 mm before a wall 0.1 mm thick, at 100 m/s, between steps.
  ParticlesDef d;
  EmitterDef e;
  e.rate = 1000, e.speed = 100, e.direction = {1, 0, 0}, e.cone = 0.2;
  d.emitters = {e};
  BoxColliderDef wall;
  wall.center = {0.001, 0, 0}, wall.half_extents = {0.00005, 10, 10};
  d.colliders = {wall};
  ParticlesRun r(d, 1.0 / 60);
  r.run(30);
  ASSERT_GT(r.count(), 400u);
  for (size_t i = 0; i < r.count(); ++i) EXPECT_LT(r.x(i).x, 0.001);
}

}  // namespace
}  // namespace truestep
