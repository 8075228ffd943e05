// Sums over all pairs beside the plain double loop, and the softened laws beside their own potentials.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/kernels/gravity/direct_sums.h"
#include "engine/math/vec3.h"

namespace truestep::gravity {
namespace {

/// w and p of one pair at distance r, in doubles.
std::pair<double, double> law(SofteningKind kind, double eps, double r) {
  Wide<double> p;
  const Wide<double> r2(r * r);
  const Wide<double> w =
      kind == SofteningKind::plummer ? PlummerLaw<double>(eps)(r2, p) : SplineLaw<double>(eps, 1e-180)(r2, p);
  return {w[0], p[0]};
}

TEST(GravitySums, InverseRootIsExactToItsPrecision) {
  double worst = 0, worst_float = 0;
  for (int k = 0; k < 20000; ++k) {
    const double x = std::ldexp(1 + k / 5000.0, k % 200 - 100);
    worst = std::max(worst, std::abs(inverse_root(Wide<double>(x))[0] * std::sqrt(x) - 1));
    const auto f = static_cast<float>(std::ldexp(1 + k / 5000.0, k % 80 - 40));
    const double y = static_cast<double>(inverse_root(Wide<float>(f))[0]);
    worst_float = std::max(worst_float, std::abs(y * std::sqrt(static_cast<double>(f)) - 1));
  }
  EXPECT_LT(worst, 5e-16) << "two units of the last place";
  EXPECT_LT(worst_float, 7e-7) << "five units of the last place of floats";
}

TEST(GravitySums, ForceIsTheSlopeOfThePotential) {
  for (const SofteningKind kind : {SofteningKind::plummer, SofteningKind::spline}) {
    for (const double r : {0.02, 0.1, 0.139, 0.141, 0.2, 0.279, 0.281, 0.5, 3.0}) {
      const double d = 1e-5, slope = (law(kind, 0.1, r - d).second - law(kind, 0.1, r + d).second) / (2 * d);
      // d^2/6 p''' <= 2e-11 * 6/eps^4 of a force of at most 1/eps^2.
      EXPECT_NEAR(law(kind, 0.1, r).first * r, slope, 2e-5) << r;
    }
  }
  // As deep in the middle as each other, and Newton's law outside of the spline's support but not of
  // Plummer's.
  EXPECT_NEAR(law(SofteningKind::spline, 0.1, 0).second, 10, 1e-12);
  EXPECT_NEAR(law(SofteningKind::plummer, 0.1, 0).second, 10, 1e-12);
  EXPECT_NEAR(law(SofteningKind::spline, 0.1, 0.2801).first, std::pow(0.2801, -3),
              1e-12 * std::pow(0.2801, -3));
  EXPECT_GT(std::abs(law(SofteningKind::plummer, 0.1, 0.2801).first * std::pow(0.2801, 3) - 1), 0.1);
}

TEST(GravitySums, EveryNumberOfBodiesMatchesTheDoubleLoop) {
  const ThreadArena one(1), two(2);
  for (const size_t n : {1, 2, 3, 5, 63, 64, 65, 257, 700, 1030}) {
    std::vector<double> x, mu;
    for (size_t i = 0; i < n; ++i) {
      const auto u = uniform4(3, 1, i);
      x.insert(x.end(), {u[0], u[1], u[2]});
      mu.push_back(i % 5 == 4 ? 0 : u[3]);
    }
    DirectScratch scratch;
    std::vector<double> a(3 * n), other(3 * n);
    const Softening s{SofteningKind::plummer, 0.01};
    direct_accelerations({x, mu}, s, a, scratch, one);
    direct_accelerations({x, mu}, s, other, scratch, two);
    EXPECT_EQ(a, other) << n;
    double potential = 0, worst = 0;
    for (size_t i = 0; i < n; ++i) {
      Vec3 sum;
      double size = 0;
      for (size_t j = 0; j < n; ++j) {
        const Vec3 d = load3(x.data(), j) - load3(x.data(), i);
        const double r = std::sqrt(norm2(d) + 1e-4);
        sum += d * (mu[j] / (r * r * r)), size += mu[j] / (r * r);
        if (j > i) potential += mu[i] * mu[j] / r;
      }
      worst = std::max(worst, norm(sum - load3(a.data(), i)) / std::max(size, 1e-300));
    }
    // A sum of n terms in two orders: n roundings at most, their root in the mean.
    EXPECT_LT(worst, 4e-16 * std::sqrt(static_cast<double>(n)) + 1e-15) << n;
    EXPECT_NEAR(direct_potential({x, mu}, s, scratch, one), potential, 1e-13 * potential + 1e-300) << n;
  }
}

}  // namespace
}  // namespace truestep::gravity
