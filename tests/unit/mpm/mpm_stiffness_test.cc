// Stresses and stiffness of elastic laws by singular values.
#include <gtest/gtest.h>

#include "engine/kernels/mpm/stiffness.h"

namespace truestep::mpm {
namespace {

using W = Wide<double>;

template <int D>
Square<D, double> filled(const double (&m)[9]) {
  Square<D, double> f;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) f(r, c) = W(m[3 * r + c]);
  }
  return f;
}
Material solid(Law law) {
  Material m;
  m.law = law, m.mu = 3e4, m.lambda = 5e4;
  return m;
}
template <int D>
double largest(const Square<D, double>& a, const Square<D, double>& b) {
  double worst = 0;
  for (int k = 0; k < D * D; ++k) worst = std::max(worst, std::abs(a.m[k][0] - b.m[k][0]));
  return worst;
}

// A stretch at which both laws are convex: nothing is left out there.
constexpr double kStretched[9] = {1.2, 0.1, -0.05, 0.02, 1.15, 0.06, 0.03, -0.04, 1.25};
// Compressed and sheared: some parts are negative.
constexpr double kPressed[9] = {0.5, 0.3, -0.2, -0.2, 0.6, 0.15, 0.1, -0.12, 0.55};
constexpr double kChange[9] = {0.3, -0.7, 0.2, 0.5, 0.1, -0.4, -0.6, 0.25, 0.8};

template <int D>
void derivatives(Law law) {
  const Material m = solid(law);
  const auto f = filled<D>(kStretched), df = filled<D>(kChange);
  Stiffness<D, double> k, other;
  const auto p = stress_and_stiffness(m, f, k);
  // P F^T is the stress that explicit steps use: rounding of a hundred operations.
  EXPECT_LT(largest(p * transposed(f), response<D, double>(m, f, determinant(f), W(1)).tau),
            1e-11 * m.lambda);
  // Central differences of the stress: the square of their width.
  const double h = 1e-5;
  auto up = f, down = f, expected = f;
  for (int i = 0; i < D * D; ++i) up.m[i] = f.m[i] + W(h) * df.m[i], down.m[i] = f.m[i] - W(h) * df.m[i];
  const auto high = stress_and_stiffness(m, up, other), low = stress_and_stiffness(m, down, other);
  for (int i = 0; i < D * D; ++i) expected.m[i] = (high.m[i] - low.m[i]) * W(0.5 / h);
  EXPECT_LT(largest(k.apply(df), expected), 1e-6 * m.lambda) << static_cast<int>(law) << ' ' << D;
}

TEST(MpmStiffness, IsTheDerivativeOfTheStress) {
  for (const Law law : {Law::corotated, Law::neo_hookean}) derivatives<2>(law), derivatives<3>(law);
}

template <int D>
double least_curvature(Law law, bool positive) {
  Stiffness<D, double> k;
  const Material m = solid(law);
  const auto f = filled<D>(kPressed);
  stress_and_stiffness(m, f, k);
  double least = HUGE_VAL;
  uint64_t state = 7;
  for (int n = 0; n < 200; ++n) {
    Square<D, double> df;
    for (int i = 0; i < D * D; ++i) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      df.m[i] = W(static_cast<double>(state >> 40) / (1 << 23) - 1);
    }
    Square<D, double> dp = k.apply(df);
    if (!positive) {
      // Control: the unmodified derivative, by differences.
      const double h = 1e-5;
      Stiffness<D, double> other;
      auto up = f, down = f;
      for (int i = 0; i < D * D; ++i) up.m[i] = f.m[i] + W(h) * df.m[i], down.m[i] = f.m[i] - W(h) * df.m[i];
      const auto high = stress_and_stiffness(m, up, other), low = stress_and_stiffness(m, down, other);
      for (int i = 0; i < D * D; ++i) dp.m[i] = (high.m[i] - low.m[i]) * W(0.5 / h);
    }
    double curvature = 0;
    for (int i = 0; i < D * D; ++i) curvature += dp.m[i][0] * df.m[i][0];
    least = std::min(least, curvature / m.lambda);
  }
  return least;
}

TEST(MpmStiffness, HasNoNegativeDirectionWhereTheEnergyHas) {
  EXPECT_GE(least_curvature<2>(Law::corotated, true), -1e-12);
  EXPECT_GE(least_curvature<3>(Law::corotated, true), -1e-12);
  EXPECT_GE(least_curvature<2>(Law::neo_hookean, true), -1e-12);
  EXPECT_GE(least_curvature<3>(Law::neo_hookean, true), -1e-12);
  EXPECT_LT(least_curvature<3>(Law::corotated, false), -0.01) << "control";
}

// The positive part of diag(2, -3) with a rotation in between: diag(2, 0), and nothing is lost of a pair of
// opposite equal values.
TEST(MpmStiffness, ThePositivePartLeavesOutWhatIsNegative) {
  const double c = 0.6, s = 0.8;
  const double both[3][2] = {{2, -3}, {1, -1}, {-2, -5}};
  for (const auto& e : both) {
    const auto part = [&](double a, double b) {
      const double m[9] = {
          c * c * a + s * s * b, c * s * (a - b), 0, c * s * (a - b), s * s * a + c * c * b, 0, 0, 0, 1};
      return filled<2>(m);
    };
    EXPECT_LT(largest(positive_part(part(e[0], e[1])), part(std::max(e[0], 0.0), std::max(e[1], 0.0))), 1e-14)
        << e[0];
  }
}

}  // namespace
}  // namespace truestep::mpm
