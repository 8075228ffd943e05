// Coordinates of joints and steps of their springs. (Faults of joints are in
// tests/scenes/refused/joints_3d.json, commands to motors in tests/scenes/rigid.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/kernels/rigid/soft_constraint.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

TEST(Rigid3dJointPlace, RatesOfCoordinatesAreTheirAxes) {
  // d coordinate / dt = turn axis . (w_b - w_a), by differences, for every definition of the rotation.
  Joint j;
  j.anchor_a = {0.1, 0.2, 0.3}, j.anchor_b = {-0.2, 0.1, 0};
  const Quat qa = normalized(Quat{0.9, 0.2, -0.3, 0.1}), qb = normalized(Quat{0.8, -0.1, 0.25, 0.4});
  const Vec3 w{0.3, -0.7, 0.5};
  const double h = 1e-6;
  const Quat later = normalized(Quat{1, 0.5 * h * w.x, 0.5 * h * w.y, 0.5 * h * w.z} * qb);
  for (const auto form : {Joint::Form::cardan, Joint::Form::swing_twist}) {
    j.form = form;
    const JointPlace before = joint_place(j, {{}, qa}, {{1, 0, 0}, qb}),
                     after = joint_place(j, {{}, qa}, {{1, 0, 0}, later});
    for (int e = 0; e < (form == Joint::Form::cardan ? 3 : 2); ++e) {
      EXPECT_NEAR((after.coordinate[3 + e] - before.coordinate[3 + e]) / h, dot(before.turns[e], w), 1e-5)
          << e;
    }
  }
  EXPECT_NEAR(unwrapped(-3, 100), -3 + 16 * 2 * M_PI, 1e-12);
}

TEST(SoftConstraint, TheOscillatorsStepIsStableAndDampsByItsRate) {
  for (const double w : {0.1, 10.0, 1e3, 1e6}) {
    for (const double zeta : {0.0, 0.1, 1.0, 30.0}) {
      const double h = 1.0 / 300;
      const OscillatorStep s = oscillator_step(w * w, 2 * zeta * w, h);
      // Eigenvalues of (v, x) -> ((1 - scale) v - push x, x + h v+): product and sum within the unit circle.
      const double product = 1 - s.scale, sum = 1 - h * s.push + product;
      EXPECT_LE(product, 1 + 1e-15);
      EXPECT_LE(std::abs(sum), 1 + product + 1e-12);
      if (w * h < 0.5) {
        EXPECT_NEAR(product, std::exp(-2 * zeta * w * h), 1e-12);
      }
    }
  }
}

/// x(1) of x'' = -w^2 x from (1, 2) in steps of h, with half a kick at both ends or without.
TEST(SoftConstraint, TheOscillatorsStepIsOfSecondOrderBetweenHalfPulls) {
  const double w = 9;
  const auto error = [&](double h, double halves) {
    const OscillatorStep s = oscillator_step(w * w, 0, h);
    double x = 1, v = 2 + halves * s.half;
    const int steps = static_cast<int>(1 / h + 0.5);
    for (int k = 0; k < steps; ++k) v = (1 - s.scale) * v - s.push * x, x += h * v;
    v -= halves * s.half * x;
    const double off = x - (std::cos(w) + 2 / w * std::sin(w));
    return std::hypot(off, (v - (2 * std::cos(w) - w * std::sin(w))) / w);
  };
  EXPECT_NEAR(std::log2(error(1e-3, 1) / error(5e-4, 1)), 2, 0.05);
  // The control: without them it is symplectic Euler's.
  EXPECT_NEAR(std::log2(error(1e-3, 0) / error(5e-4, 0)), 1, 0.05);
  EXPECT_EQ(oscillator_step(1e6, 0, 1.0 / 300).half, 0);
}

/// A spring given by hertz has the stiffness that gives its bodies that frequency in their configuration at t
/// = 0.
TEST(RigidJoints, ASpringByHertzHasOneStiffness) {
  Rigid3dDef d;
  SphereBodyDef ball;
  ball.mass = 2;
  d.bodies.push_back(ball);
  ball.mass = 3, ball.position = {2, 0, 0}, ball.radius = 0.4;
  d.bodies.push_back(ball);
  SpringJointDef spring;
  spring.a = 0, spring.b = 1, spring.hertz = 1.5, spring.damping_ratio = 0.1;
  spring.anchor = Vec3{0, 0.3, 0}, spring.anchor_b = Vec3{2, 0.3, 0};
  d.joints.push_back(spring);
  const JointList joints = build_joints(d, build_bodies(d, 1));
  // 0.3 m from both centres, 2/5 m r^2 of a ball.
  const double k = 1.0 / 2 + 1.0 / 3 + 0.09 / (0.4 * 2 * 0.25) + 0.09 / (0.4 * 3 * 0.16), w = 2 * M_PI * 1.5;
  ASSERT_EQ(joints.drives.size(), 1u);
  EXPECT_NEAR(joints.drives[0].stiffness, w * w / k, 1e-9 * w * w);
  EXPECT_NEAR(joints.drives[0].damping, 0.2 * w / k, 1e-9 * w);
}

}  // namespace
}  // namespace truestep
