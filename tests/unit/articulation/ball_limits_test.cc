// Limits of a ball: their torque is the gradient of their energy, the angles are those of a skeleton's ball,
// and dampers never pull.
#include "engine/systems/articulation/ball_limits.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/kernels/animation/rotations.h"

namespace truestep::articulation {
namespace {

Drive limited() {
  Drive d;
  d.limits = Drive::Limits::both, d.lowest = -0.4, d.highest = 0.3, d.cone = 0.5;
  d.limit_stiffness = 70, d.limit_damping = 0;
  return d;
}
double energy(const Drive& d, const Vec3& axis, const Quat& q) {
  const double numbers[] = {q.w, q.x, q.y, q.z};
  return ball_limit(d, axis, numbers, {}).energy;
}

TEST(BallLimits, TorqueIsTheSlopeOfTheEnergy) {
  const Drive d = limited();
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> u(-1, 1);
  int pushed = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 axis = normalized(Vec3{u(engine), u(engine), u(engine)});
    const Quat q = free_rotation::turn(Vec3{u(engine), u(engine), u(engine)} * 1.4);
    // Scaled by two and with the opposite sign: the same orientation.
    const double numbers[] = {-2 * q.w, -2 * q.x, -2 * q.y, -2 * q.z};
    const BallLimit l = ball_limit(d, axis, numbers, {});
    EXPECT_NEAR(l.energy, energy(d, axis, q), 1e-12 * (1 + l.energy));
    const auto [swing, twist] = animation::swing_twist(q, axis);
    const double over = std::max(0.0, norm(free_rotation::rotation_vector(swing)) - d.cone);
    const double round = std::max({0.0, twist - d.highest, d.lowest - twist});
    ASSERT_NEAR(l.energy, 35 * (over * over + round * round), 1e-9) << "angles of a skeleton's ball";
    pushed += l.energy > 0;
    const double h = 1e-6;
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Vec3& e : axes) {
      const double slope = (energy(d, axis, q * free_rotation::turn(e * h)) -
                            energy(d, axis, q * free_rotation::turn(e * -h))) /
                           (2 * h);
      // Central differences: h^2 of some 1e3, and rounding of 100 J over h.
      ASSERT_NEAR(dot(l.torque, e), -slope, 2e-7) << k;
    }
  }
  EXPECT_GT(pushed, 300) << "the control: most of them are beyond";
}

TEST(BallLimits, DampersHoldWhatGoesFurtherAndNeverPull) {
  Drive d = limited();
  d.limit_damping = 5;
  const Quat q = free_rotation::turn({0, 0.6, 0});
  const double numbers[] = {q.w, q.x, q.y, q.z};
  const Vec3 axis{1, 0, 0};
  EXPECT_NEAR(ball_limit(d, axis, numbers, {}).torque.y, -7, 1e-9);
  EXPECT_NEAR(ball_limit(d, axis, numbers, {0, 2, 0}).torque.y, -17, 1e-9);
  EXPECT_EQ(norm(ball_limit(d, axis, numbers, {0, -3, 0}).torque), 0);
  const double within[] = {1, 0, 0, 0};
  EXPECT_EQ(norm(ball_limit(d, axis, within, {9, 9, 9}).torque), 0);
}

}  // namespace
}  // namespace truestep::articulation
