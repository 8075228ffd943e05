// Contact potentials: derivatives against differences, and smoothness at both ends of their range.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/kernels/contact/barrier.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep::barrier {
namespace {

using xpbd::testing_numbers::Numbers;

TEST(Barrier, HasTheDerivativesThatItSays) {
  constexpr double kReach = 0.01;
  for (const double d : {1e-5, 1e-3, 0.004, 0.0099}) {
    const double e = 1e-4 * d;
    const Slope2 at = log_barrier(d, kReach), low = log_barrier(d - e, kReach),
                 high = log_barrier(d + e, kReach);
    // Central differences: of second order in e / d.
    EXPECT_NEAR(at.first, (high.value - low.value) / (2 * e), 1e-6 * std::abs(at.first) + 1e-9);
    EXPECT_NEAR(at.second, (high.first - low.first) / (2 * e), 1e-6 * std::abs(at.second) + 1e-6);
    EXPECT_LT(at.first, 0);
    EXPECT_GT(at.second, 0);
  }
  // Smooth where it ends, zero beyond; unbounded where features meet.
  const Slope2 end = log_barrier(kReach * (1 - 1e-9), kReach);
  EXPECT_NEAR(end.value, 0, 1e-20);
  EXPECT_NEAR(end.second, 0, 1e-7);
  EXPECT_EQ(log_barrier(kReach, kReach).value, 0);
  EXPECT_GT(log_barrier(1e-300, kReach).first * -1, 1e290);
}

TEST(Barrier, MollifierOfEdgesHasItsGradient) {
  Numbers r;
  int inside = 0;
  for (int n = 0; n < 50; ++n) {
    FeaturePoints x{r.vector(), r.vector(), r.vector(), r.vector()};
    // Nearly parallel, so that the mollifier is active.
    x[3] = x[2] + (x[1] - x[0]) + 0.05 * r.vector();
    const double bound = 0.02 * std::pow(norm2(x[1] - x[0]), 2);
    const Mollifier m = mollifier(x, bound);
    inside += m.value < 1;
    for (size_t i = 0; i < 4; ++i) {
      for (int c = 0; c < 3; ++c) {
        const double e = 1e-6;
        FeaturePoints low = x, high = x;
        (c == 0 ? low[i].x : c == 1 ? low[i].y : low[i].z) -= e;
        (c == 0 ? high[i].x : c == 1 ? high[i].y : high[i].z) += e;
        const double slope = (mollifier(high, bound).value - mollifier(low, bound).value) / (2 * e);
        const double said = c == 0 ? m.slope[i].x : c == 1 ? m.slope[i].y : m.slope[i].z;
        EXPECT_NEAR(said, slope, 1e-5 * (1 + std::abs(slope)));
      }
    }
  }
  EXPECT_GT(inside, 20);
  const FeaturePoints crossed{Vec3{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}};
  EXPECT_EQ(mollifier(crossed, 1e-3).value, 1);
}

TEST(Barrier, FrictionGrowsWithSmallSlipsAndStaysForLargeOnes) {
  constexpr double kStill = 1e-3;
  for (const double y : {1e-5, 4e-4, 9e-4, 2e-3}) {
    const double e = 1e-4 * y;
    const Slope2 at = smooth_slip(y, kStill);
    const double slope = (smooth_slip(y + e, kStill).value - smooth_slip(y - e, kStill).value) / (2 * e);
    EXPECT_NEAR(at.first * y, slope, 1e-7);
    const double bend =
        (smooth_slip(y + e, kStill).first * (y + e) - smooth_slip(y - e, kStill).first * (y - e)) / (2 * e);
    EXPECT_NEAR(at.second, bend, 1e-6 / kStill);
  }
  EXPECT_EQ(smooth_slip(5 * kStill, kStill).first * 5 * kStill, 1);
  EXPECT_NEAR(smooth_slip(kStill, kStill).value, smooth_slip(kStill * (1 - 1e-12), kStill).value, 1e-12);
}

}  // namespace
}  // namespace truestep::barrier
