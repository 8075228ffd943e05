// The slowest mode of a tall pile is damped (docs/standing.md). (That what leans keeps its height and that a
// heap falls asleep is in tests/scenes/rigid and tests/scenes/sleep.)
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/kernels/rigid/penetration_offset.h"
#include "engine/kernels/rigid/soft_constraint.h"

namespace truestep {
namespace {

/// Growth in a minute of a mode of which a sweep removes the fraction eps, in substeps of h: depth S h,
/// velocity u, warm-start impulse y, offset p; with offsets that adapt in every step of four substeps.
double growth(double eps, double hertz_share, double damping_ratio, double learnt, double h) {
  const auto soft = soft_constraint(hertz_share / h, damping_ratio, h);
  const double leak = soft.impulse_scale / soft.mass_scale, rate = soft.bias_rate * h;
  double S = 1, u = 0, y = 0, p = 0;
  const auto size = [&] { return std::sqrt(S * S * eps + u * u + y * y / eps); };
  double early = 0, late = 0;
  const int steps = 60 * 120;
  for (int k = 0; k < steps; ++k) {
    const double start = S;
    for (int i = 0; i < 4; ++i) {
      u += y;
      const double d = eps * (u + rate * (S + p)) + leak * y;
      u -= d, y -= d, S += u;
      const double r = eps * u;
      u -= r, y -= r;
    }
    p += learnt * start;
    if (k >= steps / 2 - 600 && k < steps / 2) early = std::max(early, size());
    if (k >= steps - 600) late = std::max(late, size());
  }
  return late / early;
}

TEST(Rigid2dStanding, TheSlowestModeOfAHundredRowsIsDamped) {
  const double h = 1.0 / 240, dt = 1.0 / 60, eps = std::pow(std::numbers::pi / 200, 2);
  const double learnt = penetration_offset_rule(0.21 / h, 1 / h, dt, 0.5).learnt;
  for (const double crowd : {2.0, 4.0, 6.0}) {
    EXPECT_LT(growth(eps, 0.21 * std::sqrt(2 / crowd), 20, learnt, h), 0.5) << crowd;
  }
  // Controls: offsets that adapt within a second, and contacts stiffer than two sweeps can handle.
  EXPECT_GT(growth(eps / 2, 0.2, 10, dt / (dt + 1), h), 2);
  EXPECT_GT(growth(eps, 0.25, 20, 0, h), 2);
  EXPECT_LT(growth(eps, 0.21, 20, 0, h), 0.5);
}

}  // namespace
}  // namespace truestep
