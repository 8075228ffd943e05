// Tops that turn thousands of radians in a step: their momentum and energy stay, whatever becomes of the
// phase. A free top at 1e6 rad/s doubled its energy at 60 Hz.
#include "engine/kernels/rigid/fast_rotation.h"

#include <gtest/gtest.h>

namespace truestep::free_rotation {
namespace {

double twice_energy(const Motion& m, const Vec3& I) {
  return dot(m.angular_velocity, momentum(m, I));
}

TEST(FastRotation, MomentumAndEnergyStayAtAnySpeed) {
  // A brick, a plate, a rod with hardly different sides, a disc, and balls to rounding.
  for (const Vec3 I : {Vec3{1, 2, 2.5}, Vec3{1, 1.1, 2.05}, Vec3{0.01, 1, 1.001}, Vec3{1, 1, 2},
                       Vec3{1, 1 + 1e-15, 1}, Vec3{1, 1, 1}}) {
    for (const Vec3 about : {Vec3{1, 2, 3}, Vec3{0.01, 1, 0.01}, Vec3{1, 0, 0}, Vec3{1e-9, 0, 1}}) {
      for (const double speed : {10.0, 1e3, 1e4, 1e6, 1e9}) {
        Motion m{normalized(Quat{0.9, 0.1, -0.3, 0.2}), about * (speed / norm(about))};
        const double before = twice_energy(m, I);
        const Vec3 L = momentum(m, I);
        for (int k = 0; k < 50; ++k) m = advance_fast(m, I, 1.0 / 60);
        // Below kMostParts the error of the method, largest for the rod, which turns up to ten times as fast
        // in parts of its motion as at their start (2e-8); above it that of rounding.
        EXPECT_NEAR(twice_energy(m, I) / before, 1, 1e-7)
            << speed << " rad/s about " << about.x << " " << I.x;
        EXPECT_LT(norm(momentum(m, I) - L), 1e-10 * norm(L)) << speed;
      }
    }
  }
}

// The control: without with_energy a top at 1e6 rad/s has another energy after a second.
TEST(FastRotation, PartsTooLargeToFollowLoseTheEnergy) {
  const Vec3 I{1, 2, 2.5};
  Motion m{{}, Vec3{1, 2, 3} * 2.67e5};
  const double before = twice_energy(m, I);
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    m = advance(m, I, 1.0 / 60);
    most = std::max(most, std::abs(twice_energy(m, I) / before - 1));
  }
  EXPECT_GT(most, 0.05);
}

TEST(FastRotation, AnOrientationIsTurnedToAnEnergyAsLittleAsNeeded) {
  const Vec3 I{1, 2, 3}, L{0.3, -2, 1};
  const Quat q = normalized(Quat{0.5, -0.2, 0.6, 0.1});
  const auto twice = [&](const Quat& at) { return dot(L, spin_of(at, L, I)); };
  // The control: what has its energy already stays as it is.
  const Quat same = with_energy(q, L, I, twice(q));
  EXPECT_NEAR(std::abs(same.w * q.w + same.x * q.x + same.y * q.y + same.z * q.z), 1, 1e-15);
  for (const double share : {0.9, 0.999, 1.001, 1.1}) {
    const Quat to = with_energy(q, L, I, share * twice(q));
    EXPECT_NEAR(twice(to), share * twice(q), 1e-14);
    EXPECT_GT(std::abs(to.w * q.w + to.x * q.x + to.y * q.y + to.z * q.z), 1 - std::abs(share - 1)) << share;
  }
  // Not below that of a turn about the axis of the largest moment.
  EXPECT_NEAR(twice(with_energy(q, L, I, 0)), norm2(L) / 3, 1e-14);
}

}  // namespace
}  // namespace truestep::free_rotation
