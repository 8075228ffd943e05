// Joints of rigid bodies in 3-D, each kind against a closed form of its own, with a control that fails it.
#include "tests/validation/rigid/rigid3d_joints.h"

#include <gtest/gtest.h>

namespace truestep::testing {
using namespace rigid3d;
namespace {

using std::numbers::pi;

TEST(Rigid3dJoints, APendulumSwingsAtItsPeriod) {
  // Compound pendulum: a quarter swing from level takes K(sin(pi/4)) sqrt(I / m g l), K = 1.8540746773.
  const double quarter = 1.8540746773013719 * std::sqrt(kRodMoment / 10 / (0.5 * kG));
  for (const Rigid3dDef& d : {pendulum(hung<BallJointDef>()), pendulum(hung<HingeJointDef>())}) {
    RigidRun run(d, 1.0 / 240);
    double passed = 0;
    while (run.x(0).x > 0 && run.t() < 2) {
      passed = run.t() + run.h * run.x(0).x / std::max(1e-9, -run.v(0).x * run.h);
      run.run(1);
    }
    EXPECT_NEAR(passed, quarter, 5e-3);
    EXPECT_LT(run.observed("joints.gap"), 1e-3);
    EXPECT_NEAR(run.observed("energy.total"), 0, 0.01 * 10 * kG * 0.5);
  }
  // The control: a fixed joint does not swing.
  RigidRun held(pendulum(hung<FixedJointDef>()), 1.0 / 240);
  held.seconds(2);
  EXPECT_NEAR(held.x(0).x, 0.5, 2e-3);
}

TEST(Rigid3dJoints, ASliderSlidesAlongItsAxisOnly) {
  SliderJointDef j = hung<SliderJointDef>();
  j.axis = {1, -1, 0};
  RigidRun run(pendulum(j), 1.0 / 240);
  run.seconds(1);
  // Half of g along a slope of 45 degrees in each direction.
  EXPECT_NEAR(run.x(0).x - 0.5, 0.25 * kG, 5e-3 * 2.45);
  EXPECT_NEAR(run.x(0).y, -0.25 * kG, 5e-3 * 2.45);
  EXPECT_LT(norm(run.w(0)), 1e-3);
  EXPECT_NEAR(run.observed("joint.j.position"), 0.25 * kG * std::sqrt(2.0), 5e-3 * 3.5);
}

TEST(Rigid3dJoints, ASliderThatTurnsKeepsTheAngularMomentum) {
  Rigid3dDef d;
  d.precision = Rigid3dDef::Precision::f64;
  d.bodies = {bob({-0.5, 0, 0}), bob({0.5, 0, 0})};
  std::get<SphereBodyDef>(d.bodies[0]).velocity = {0, -1, 0};
  std::get<SphereBodyDef>(d.bodies[1]).velocity = {0.3, 1, 0};
  SliderJointDef j;
  j.a = 0, j.b = 1, j.axis = {1, 0, 0};
  d.joints.push_back(j);
  RigidRun run(d, 1.0 / 240, 1, kNoGravity);
  const double before = run.observed("angular_momentum.z"), px = run.observed("momentum.x");
  run.seconds(2);
  EXPECT_GT(norm(run.x(1) - run.x(0)), 2);  // it has slid far
  EXPECT_NEAR(run.observed("angular_momentum.z"), before, 1e-3 * before);
  EXPECT_NEAR(run.observed("momentum.x"), px, 1e-9);
  // The control: with one end held its momentum is not conserved.
  j.a = -1;
  d.joints = {j};
  RigidRun held(d, 1.0 / 240, 1, kNoGravity);
  held.seconds(0.5);
  EXPECT_GT(std::abs(held.observed("angular_momentum.z") - before), 1e-2 * before);
}

/// A ball on a spring to the origin, released 1 m beyond its rest length.
Rigid3dDef oscillator(double stiffness, double damping) {
  Rigid3dDef d;
  d.bodies = {bob({3, 0, 0})};
  SpringJointDef j = hung<SpringJointDef>();
  j.length = 2, j.stiffness = stiffness, j.damping = damping;
  d.joints.push_back(j);
  return d;
}

TEST(Rigid3dJoints, ASpringSwingsAtItsFrequencyAndDiesAtItsRate) {
  const double w = 2 * pi, damping = 0.1, rate = 0.5 * damping, wd = std::sqrt(w * w - rate * rate);
  const auto exact = [&](double t) {
    return std::exp(-rate * t) * (std::cos(wd * t) + rate / wd * std::sin(wd * t));
  };
  const auto off = [&](double stiffness) {
    RigidRun run(oscillator(stiffness, damping), 1.0 / 60, 1, kNoGravity);
    return worst(run, 600, [&](const RigidRun& r) { return r.x(0).x - 2 - exact(r.t()); });
  };
  // Ten periods. Velocity and position are half a substep apart: w h / 2 = 0.0105 at 60 Hz and five substeps.
  EXPECT_LT(off(w * w), 0.015);
  // The control: a hundredth more stiffness is a third of a radian after ten periods.
  EXPECT_GT(off(1.01 * w * w), 0.1);
}

TEST(Rigid3dJoints, AnyStiffnessIsStable) {
  for (const double stiffness : {1e3, 1e5, 1e7, 1e9, 1e12}) {
    RigidRun run(oscillator(stiffness, 0), 1.0 / 60, 1, kNoGravity);
    // No farther out than at the start, except for the half substep between velocity and position, w h / 2;
    // and a spring that no step resolves comes to rest.
    EXPECT_LT(worst(run, 300, [](const RigidRun& r) { return r.x(0).x - 2; }), 1.01) << stiffness;
    if (stiffness > 1e6) {
      EXPECT_NEAR(run.x(0).x, 2, 1e-3) << stiffness;
    }
  }
}

TEST(Rigid3dJoints, ARodOfFixedLengthSwingsAndARopeGoesTaut) {
  // A point of mass on a rod of 1 m from 0.1 rad: T = 2 pi sqrt(L / g) (1 + 0.1^2 / 16).
  Rigid3dDef d;
  d.bodies = {bob({std::sin(0.1), -std::cos(0.1), 0})};
  DistanceJointDef j = hung<DistanceJointDef>();
  d.joints = {j};
  const double period = 2 * pi * std::sqrt(1 / kG) * (1 + 0.01 / 16);
  const auto crossings = [](const Rigid3dDef& scene) {
    RigidRun run(scene, 1.0 / 240);
    double last = 0;
    for (int n = 0; n < 10; ++n) {
      const bool right = run.x(0).x > 0;
      while ((run.x(0).x > 0) == right && run.t() < 20) run.run(1);
      last = run.t() - run.x(0).x / run.v(0).x;
    }
    EXPECT_LT(std::abs(norm(run.x(0)) - 1), 1e-4);
    EXPECT_NEAR(run.observed("joint.j.length"), 1, 1e-4);
    return last;
  };
  // Nine and a half half-periods; half a substep is 4e-4 s.
  EXPECT_NEAR(crossings(d), 4.75 * period, 2e-3);
  // A rope from a fixed point: free fall for 1 m, then it holds.
  DistanceJointDef rope = hung<DistanceJointDef>();
  rope.maximum = 2;
  d.bodies = {bob({0, -1, 0})}, d.joints = {rope};
  RigidRun run(d, 1.0 / 240);
  run.seconds(0.4);
  EXPECT_NEAR(run.x(0).y, -1 - 0.5 * kG * 0.16, 0.01);
  run.seconds(2);
  EXPECT_NEAR(run.x(0).y, -2, 1e-3);
  // And a strut with a minimum length.
  DistanceJointDef strut = hung<DistanceJointDef>();
  strut.minimum = 0.5;
  d.bodies = {bob({0, 1, 0})}, d.joints = {strut};
  RigidRun held(d, 1.0 / 240);
  held.seconds(2);
  EXPECT_NEAR(held.x(0).y, 0.5, 1e-3);
}

TEST(Rigid3dJoints, AUniversalJointsOutputRunsUnevenly) {
  // w2 / w1 = cos b / (1 - sin^2 b cos^2 a), a from where the driving arm lies in the plane of the shafts.
  const double b = pi / 6, speed = 2;
  const Vec3 out{std::cos(b), std::sin(b), 0};
  Rigid3dDef d;
  d.precision = Rigid3dDef::Precision::f64;
  BoxBodyDef shaft = box({0.5, 0.05, 0.05}, {-0.5, 0, 0});
  d.bodies.push_back(shaft);
  shaft.position = out * 0.5, shaft.axis = {0, 0, 1}, shaft.angle = b;
  d.bodies.push_back(shaft);
  HingeJointDef first, second;
  first.id = "in", first.b = 0, first.anchor = Vec3{-0.5, 0, 0}, first.axis = {1, 0, 0};
  first.motor_speed = speed;
  second.id = "out", second.b = 1, second.anchor = out * 0.5, second.axis = out;
  UniversalJointDef cross;
  cross.a = 0, cross.b = 1, cross.anchor = Vec3{}, cross.axis = {0, 1, 0}, cross.axis_b = {0, 0, 1};
  d.joints = {first, second, cross};
  RigidRun run(d, 1.0 / 600, 1, kNoGravity);
  run.seconds(0.5);
  double most = 0, low = 1e9, high = 0;
  for (int k = 0; k < 2400; ++k) {
    run.run(1);
    const double a = run.observed("joint.in.angle"), c = std::cos(a), s = std::sin(b);
    const double ratio = dot(run.w(1), out) / run.w(0).x;
    most = std::max(most, std::abs(ratio - std::cos(b) / (1 - s * s * c * c)));
    low = std::min(low, ratio), high = std::max(high, ratio);
  }
  // Half a substep of 3e-4 s at 2 rad/s turns by 7e-4.
  EXPECT_LT(most, 2e-3);
  EXPECT_NEAR(low, std::cos(b), 2e-3);
  EXPECT_NEAR(high, 1 / std::cos(b), 2e-3);
  EXPECT_LT(run.observed("joints.tilt"), 1e-3);
}

TEST(Rigid3dJoints, AConeAndATwistEndWhereTheyShould) {
  // A rod standing on its end falls over to the cone's edge.
  Rigid3dDef d;
  BoxBodyDef b = box({0.05, 0.5, 0.05}, {0, 0.5, 0});
  b.mass = 10, b.angular_velocity = {0.05, 0, 0.1};
  d.bodies = {b};
  ConeTwistJointDef j = hung<ConeTwistJointDef>();
  j.axis = {0, 1, 0}, j.swing = 0.7;
  d.joints = {j};
  RigidRun run(d, 1.0 / 60);
  run.seconds(6);
  EXPECT_NEAR(run.observed("joint.j.turn_y"), 0.7, 2e-3);
  EXPECT_NEAR(run.x(0).y, 0.5 * std::cos(0.7), 2e-3);
  // The control: without the cone it hangs.
  j.swing.reset();
  d.joints = {j};
  RigidRun loose(d, 1.0 / 60);
  double lowest = 1;
  for (int k = 0; k < 180; ++k) loose.run(1), lowest = std::min(lowest, loose.x(0).y);
  EXPECT_LT(lowest, 0);
  // A twist about the axis stops at its limit; the control continues.
  j.twist_upper = 2.5;
  b.angular_velocity = {0, 3, 0};
  d.bodies = {b}, d.joints = {j};
  RigidRun twist(d, 1.0 / 60, 1, kNoGravity);
  twist.seconds(2);
  EXPECT_NEAR(twist.observed("joint.j.turn_x"), 2.5, 2e-3);
  EXPECT_LT(norm(twist.w(0)), 1e-2);
  j.twist_upper = 100;
  d.joints = {j};
  RigidRun spins(d, 1.0 / 60, 1, kNoGravity);
  spins.seconds(2);
  EXPECT_NEAR(spins.observed("joint.j.turn_x"), 6, 0.02);
}

TEST(Rigid3dJoints, ItBreaksAtTheLoadThatShouldBreakIt) {
  Rigid3dDef d;
  d.bodies = {bob({0, -1, 0})};
  const auto breaks = [&d](const AnyJointDef& j) {
    d.joints = {j};
    RigidRun run(d);
    run.seconds(2);
    return run.observed("joints.broken") > 0 && run.x(0).y < -3;
  };
  // A weight of 9.81 N, 5 % above and below.
  BallJointDef ball_joint = hung<BallJointDef>();
  ball_joint.break_force = kG / 1.05;
  EXPECT_TRUE(breaks(ball_joint));
  ball_joint.break_force = kG * 1.05;
  EXPECT_FALSE(breaks(ball_joint));
  DistanceJointDef rod_joint = hung<DistanceJointDef>();
  rod_joint.break_force = kG / 1.05;
  EXPECT_TRUE(breaks(rod_joint));
  rod_joint.break_force = kG * 1.05;
  EXPECT_FALSE(breaks(rod_joint));
  // A cantilever of 10 kg: 49.05 N m at its root.
  d.bodies = {rod()};
  FixedJointDef root = hung<FixedJointDef>();
  root.break_torque = 10 * kG * 0.5 / 1.05;
  EXPECT_TRUE(breaks(root));
  root.break_torque = 10 * kG * 0.5 * 1.05;
  EXPECT_FALSE(breaks(root));
}

TEST(Rigid3dJoints, WhatIsHingedToAMovingBodyIsTakenAlong) {
  Rigid3dDef d;
  BoxBodyDef cart = box({0.2, 0.2, 0.2}, {});
  cart.motion = BodyDef::Motion::kinematic, cart.velocity = {1, 0, 0}, cart.angular_velocity = {0, 0, 1};
  BoxBodyDef held = box({0.1, 0.1, 0.1}, {0, 0.5, 0});
  d.bodies = {cart, held};
  FixedJointDef j;
  j.a = 0, j.b = 1, j.anchor = Vec3{};
  d.joints = {j};
  RigidRun run(d, 1.0 / 60, 1, kNoGravity);
  run.seconds(2);
  EXPECT_NEAR(norm(run.x(1) - run.x(0) - Vec3{-0.5 * std::sin(2.0), 0.5 * std::cos(2.0), 0}), 0, 5e-3);
  EXPECT_LT(run.observed("joints.gap"), 2e-3);
}

}  // namespace
}  // namespace truestep::testing
