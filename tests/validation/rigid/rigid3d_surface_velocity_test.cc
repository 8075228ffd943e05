// Belts in space (surface_velocity), the twin of the plane's surface_speed: friction brings what lies on them
// to the velocity of their surface, and takes as much momentum from them as it gives.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
namespace {

using namespace testing;
using rigid3d::BodyDef;
using rigid3d::Rigid3dDef;

constexpr double kG = 9.81;

rigid3d::BoxBodyDef belt(Vec3 velocity) {
  rigid3d::BoxBodyDef d = box({10, 0.5, 10}, {0, -0.5, 0});
  d.motion = BodyDef::Motion::fixed, d.surface_velocity = velocity;
  return d;
}

Rigid3dDef crate_on(const rigid3d::AnyBodyDef& below, double friction = 0.5) {
  Rigid3dDef def;
  def.friction = friction;
  def.bodies = {below, box({0.3, 0.3, 0.3}, {0, 0.3, 0})};
  return def;
}

TEST(SurfaceVelocity, ABeltCarriesACrateAlongIt) {
  for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
    for (const Vec3 u : {Vec3{1.5, 0, 0}, Vec3{0, 0, -0.8}, Vec3{0.6, 0, 0.8}}) {
      Rigid3dDef def = crate_on(belt(u));
      def.precision = precision;
      RigidRun r(def);
      r.seconds(3);
      EXPECT_LT(norm(r.v(1) - u), 1e-3);
      // Behind the belt by u^2 / (2 mu g), the way on which it slipped, and by at most a step's.
      const double lag = norm2(u) / (2 * 0.5 * kG);
      EXPECT_LT(norm(r.x(1) - Vec3{0, 0.3, 0} - u * (3 - lag / norm(u))), norm(u) / 60) << norm(u);
      EXPECT_LT(norm(r.w(1)), 1e-3);
    }
  }
}

TEST(SurfaceVelocity, WithoutFrictionOrAlongTheNormalItDoesNothing) {
  RigidRun smooth(crate_on(belt({1.5, 0, 0}), 0));
  smooth.seconds(1);
  EXPECT_EQ(smooth.v(1).x, 0);
  RigidRun upwards(crate_on(belt({0, 1.5, 0})));
  upwards.seconds(1);
  EXPECT_LT(norm(upwards.x(1) - Vec3{0, 0.3, 0}), 1e-3);
  // The control: as much along the belt takes it away.
  RigidRun control(crate_on(belt({1.5, 0, 0})));
  control.seconds(1);
  EXPECT_GT(control.x(1).x, 1);
}

TEST(SurfaceVelocity, ItTurnsWithItsBody) {
  rigid3d::BoxBodyDef turned = belt({1.5, 0, 0});
  turned.axis = {0, 1, 0}, turned.angle = 0.5 * M_PI;  // x of the body points along -z
  RigidRun r(crate_on(turned));
  r.seconds(2);
  EXPECT_LT(norm(r.v(1) - Vec3{0, 0, -1.5}), 1e-3);
  // Of a compound about whose principal axes the solver works, too.
  rigid3d::CompoundBodyDef two;
  rigid3d::BoxPartDef part;
  part.half_extents = {5, 0.5, 1}, part.position = {0, -0.5, 0.3}, part.axis = {0, 1, 0}, part.angle = 0.3;
  two.parts = {part};
  two.density = 100, two.surface_velocity = {0.5, 0, 0};
  Rigid3dDef def = crate_on(two);
  rigid3d::BoxBodyDef ice = belt({});
  ice.position.y = -1.5;
  def.bodies.push_back(ice);
  def.sleeping = false;
  RigidRun free(def);
  free.seconds(1);
  const Vec3 carried = free.v(1) - free.v(0);
  EXPECT_NEAR(carried.x, 0.5, 0.01);
  EXPECT_NEAR(carried.z, 0, 0.01);
}

TEST(SurfaceVelocity, AFreeBeltIsPushedBack) {
  Rigid3dDef def;
  rigid3d::BoxBodyDef plank = box({3, 0.1, 1}, {0, 0.1, 0}), crate = box({0.2, 0.2, 0.2}, {0, 0.4, 0});
  plank.mass = 20, plank.surface_velocity = {1, 0, 0}, crate.mass = 10;
  plank.friction = crate.friction = 1;
  rigid3d::PlaneBodyDef ice = ground();
  ice.friction = 0;
  def.bodies = {ice, plank, crate};
  RigidRun r(def);
  r.seconds(1);
  EXPECT_NEAR(r.observed("momentum.x"), 0, 1e-3);
  EXPECT_NEAR(r.v(2).x - r.v(1).x, 1, 1e-3);
  EXPECT_NEAR(r.v(1).x, -1.0 / 3, 1e-3);
}

TEST(SurfaceVelocity, ItKeepsItsLoadAwake) {
  // Slower than what may fall asleep.
  RigidRun slow(crate_on(belt({0.005, 0, 0}))), still(crate_on(belt({})));
  slow.seconds(5), still.seconds(5);
  EXPECT_EQ(slow.observed("awake"), 1);
  EXPECT_NEAR(slow.x(1).x, 0.025, 1e-3);
  EXPECT_EQ(still.observed("awake"), 0) << "the control";
}

}  // namespace
}  // namespace truestep
