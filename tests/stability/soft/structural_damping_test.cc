// generalized_alpha's spectral radius at infinity is the requested one, and Newmark's beta and gamma have
// their published effects. (What a scene asks for is in
// tests/scenes/equations/damping_that_is_asked_for.json.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/convergence/problems.h"

namespace truestep::test {
namespace {

// x'' = -omega^2 x.
class Spring final : public RightHandSide, public SecondOrder {
 public:
  explicit Spring(double omega) : k_(omega * omega) {}
  size_t size() const override { return 2; }
  void rate(double, const double* y, double* d) const override { d[0] = y[1], d[1] = -k_ * y[0]; }
  const SecondOrder* second_order() const override { return this; }
  void acceleration(double, const double* x, const double*, double* a) const override { a[0] = -k_ * x[0]; }
  bool depends_on_velocity() const override { return false; }
  bool has_jacobian() const override { return true; }
  using RightHandSide::jacobian;
  void jacobian(double, const double*, const double*, double* dadx, double* dadv) const override {
    dadx[0] = -k_, dadv[0] = 0;
  }

 private:
  double k_;
};

// |x| after `steps` of length h from (1, 0).
double amplitude(const char* method, double omega, double h, uint64_t steps,
                 const StructuralDamping& damping) {
  const Spring f(omega);
  Workspace workspace;
  Carry carry;
  double y[2] = {1, 0};
  Advance in{.f = f,
             .t = 0,
             .t_end = h * static_cast<double>(steps),
             .y = y,
             .workspace = workspace,
             .carry = carry,
             .fixed_steps = steps,
             .damping = damping};
  find_integrator(method)->advance(in);
  return std::abs(y[0]);
}

// Where h omega is 1e6, all three eigenvalues are -r: |x_n| = (c0 + c1 n + c2 n^2) r^n, of which the power of
// n is divided out. What is left of c1 and c0 falls as 1/N.
double radius_at_infinity(double asked) {
  const auto n = std::min<uint64_t>(1000, static_cast<uint64_t>(110 / -std::log(asked)));
  const StructuralDamping damping{.spectral_radius = asked};
  const double once = amplitude("generalized_alpha", 1e6, 1, n, damping),
               twice = amplitude("generalized_alpha", 1e6, 1, 2 * n, damping);
  return std::exp((std::log(twice / once) - 2 * std::log(2)) / static_cast<double>(n));
}

TEST(GeneralizedAlpha, TheSpectralRadiusIsTheOneAskedFor) {
  for (const double asked : {0.1, 0.3, 0.5, 0.8, 0.9, 0.98}) {
    const double found = radius_at_infinity(asked);
    std::printf("asked %.2f found %.4f\n", asked, found);
    EXPECT_NEAR(found, asked, 0.02 * asked);
    // Control: a twentieth less or more would be detected.
    EXPECT_GT(std::abs(found - 0.95 * asked), 0.02 * asked);
  }
  // 0: gone after a few steps; 1: an oscillation at any step keeps its amplitude.
  EXPECT_LT(amplitude("generalized_alpha", 1e6, 1, 6, {.spectral_radius = 0}), 1e-9);
  EXPECT_GT(amplitude("generalized_alpha", 1e6, 1, 6, {.spectral_radius = 0.5}), 1e-3);
  double largest = 0;
  for (uint64_t n = 1990; n < 2000; ++n) {
    largest = std::max(largest, amplitude("generalized_alpha", 1, 1, n, {.spectral_radius = 1}));
  }
  EXPECT_NEAR(largest, 1, 0.05);
}

TEST(Newmark, GammaAboveOneHalfDampsAndBetaDecidesOnStability) {
  // Average acceleration keeps the amplitude, gamma = 0.7 does not.
  double kept = 0, damped = 0;
  for (uint64_t n = 190; n < 200; ++n) {
    kept = std::max(kept, amplitude("newmark", 1, 1, n, {}));
    damped = std::max(damped, amplitude("newmark", 1, 1, n, {.newmark_beta = 0.36, .newmark_gamma = 0.7}));
  }
  EXPECT_NEAR(kept, 1, 0.05);
  EXPECT_LT(damped, 1e-3);
  // Linear acceleration, beta = 1/6: stable up to omega h = 2 sqrt(3), Hughes 1987, eq. 9.1.19.
  const StructuralDamping linear{.newmark_beta = 1.0 / 6};
  EXPECT_LT(amplitude("newmark", 1, 0.999 * std::sqrt(12), 4000, linear), 100);
  EXPECT_GT(amplitude("newmark", 1, 1.001 * std::sqrt(12), 4000, linear), 1e6);
}

}  // namespace
}  // namespace truestep::test
