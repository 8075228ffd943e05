// The accuracy of joints as constraints between bodies on the reference cases that `articulation` solves to
// many digits: errors fall at first order with the step, and stay below the cases' low precision.
#include <gtest/gtest.h>

#include "tests/validation/rigid/rigid3d_joints.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

Rigid3dDef exact() {
  Rigid3dDef d;
  d.precision = Rigid3dDef::Precision::f64, d.sleeping = false;
  return d;
}

/// Distance from where the pendulum A01 (m = 1, L = 1, released level) is after ten seconds.
double a01(double h, double gravity = kG) {
  Rigid3dDef d = exact();
  d.bodies = {bob({1, 0, 0})};
  d.joints = {hung<DistanceJointDef>()};
  RigidRun run(d, h, 1, {0, -gravity, 0});
  run.seconds(10);
  return norm(run.x(0) - Vec3{0.27508746257611686, -0.96141920509912506, 0});
}

TEST(Rigid3dReference, A01PendulumAfterTenSeconds) {
  const double coarse = a01(1.0 / 240), fine = a01(1.0 / 960);
  EXPECT_LT(fine, 0.1);  // the case's low precision
  EXPECT_GT(coarse, 2.5 * fine);
  // The control: a hundredth more weight is half a radian away.
  EXPECT_GT(a01(1.0 / 960, 1.01 * kG), 0.1);
}

/// Largest error of the two angles of the double pendulum from 90, 90 degrees after t = 1 s.
double double_pendulum(double h) {
  Rigid3dDef d = exact();
  d.bodies = {bob({1, 0, 0}), bob({2, 0, 0})};
  DistanceJointDef second;
  second.a = 0, second.b = 1;
  d.joints = {hung<DistanceJointDef>(), second};
  RigidRun run(d, h);
  run.seconds(1);
  const auto off = [](const Vec3& at, double angle) {
    return norm(at - Vec3{std::sin(angle), -std::cos(angle), 0});
  };
  return std::max(off(run.x(0), -0.62508769980639063), off(run.x(1) - run.x(0), -1.0345850856800123));
}

TEST(Rigid3dReference, DoublePendulumAfterASecond) {
  const double coarse = double_pendulum(1.0 / 240), fine = double_pendulum(1.0 / 960);
  EXPECT_LT(fine, 3e-3);  // semi-implicit Euler of others at 1 kHz: 2.9e-3
  EXPECT_GT(coarse, 2.5 * fine);
}

/// Angle by which a top on a ball joint has precessed in a second: I1 = 0.02 about the pivot, I3 = 0.005.
double precession(double h, double rate) {
  Rigid3dDef d = exact();
  // A box of 1 kg, (x^2 + z^2) / 3 = 0.005 about its axis y and 0.01 across it; 0.1 m from the pivot add
  // 0.01.
  BoxBodyDef top = box({std::sqrt(0.0075), 0.15, std::sqrt(0.0075)}, {});
  top.mass = 1;
  const double tilt = std::numbers::pi / 6, spin = 100;
  const Vec3 axis{std::sin(tilt), std::cos(tilt), 0};
  top.axis = {0, 0, -1}, top.angle = tilt;
  top.position = axis * 0.1;
  // Steady: w = rate up + what is left of w3 along the axis.
  const Vec3 w = Vec3{0, rate, 0} + axis * (spin - rate * std::cos(tilt));
  top.angular_velocity = w, top.velocity = cross(w, top.position);
  d.bodies = {top};
  d.joints = {hung<BallJointDef>()};
  RigidRun run(d, h);
  run.seconds(1);
  EXPECT_LT(run.observed("joints.gap"), 1e-3);
  return std::atan2(-run.x(0).z, run.x(0).x);
}

TEST(Rigid3dReference, ATopOnABallJointPrecessesSteadily) {
  const double rate = 2.11729327930849314;
  const double coarse = std::abs(precession(1.0 / 240, rate) - rate),
               fine = std::abs(precession(1.0 / 960, rate) - rate);
  // What is left is the joint's softness, visible as the gap of a spinning top at any step.
  EXPECT_LT(coarse, 2e-3);
  EXPECT_LT(fine, 2e-3);
  // The control: 3 % away from the steady rate it nutates, and is not where steady precession would take it.
  EXPECT_GT(std::abs(precession(1.0 / 960, 1.03 * rate) - 1.03 * rate), 0.02);
}

}  // namespace
}  // namespace truestep::testing
