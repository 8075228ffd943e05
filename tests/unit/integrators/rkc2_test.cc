// rkc2: the determination of its number of stages, with a spectral radius that is given or estimated.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {
namespace {

// u_t = u_xx on n cells between cold ends; one wave decays exactly like e^{-lambda t}.
class Rod final : public RightHandSide {
 public:
  enum class Radius : uint8_t { given, found, wrong };
  Rod(size_t n, Radius radius) : n_(n), radius_(radius) {}
  size_t size() const override { return n_ - 1; }
  void rate(double, const double* y, double* d) const override {
    const size_t m = n_ - 1;
    const double s = double(n_) * double(n_);
    for (size_t i = 0; i < m; ++i) {
      d[i] = s * ((i > 0 ? y[i - 1] : 0) - 2 * y[i] + (i + 1 < m ? y[i + 1] : 0));
    }
  }
  std::optional<double> spectral_radius(double, const double*) const override {
    if (radius_ == Radius::found) return std::nullopt;
    return (radius_ == Radius::wrong ? 0.05 : 1) * 4 * double(n_) * double(n_);
  }
  double lambda() const {
    const double s = std::sin(std::numbers::pi / (2 * double(n_)));
    return 4 * double(n_) * double(n_) * s * s;
  }

 private:
  size_t n_;
  Radius radius_;
};

struct Outcome {
  double error;
  Statistics work;
};
Outcome run(const Rod& f, double t_end, double tolerance) {
  std::vector<double> y(f.size());
  const auto wave = [&](size_t i) {
    return std::sin(std::numbers::pi * double(i + 1) / double(f.size() + 1));
  };
  for (size_t i = 0; i < y.size(); ++i) y[i] = wave(i);
  Workspace workspace;
  Carry carry;
  Statistics work;
  Advance in{.f = f,
             .t = 0,
             .t_end = t_end,
             .y = y.data(),
             .workspace = workspace,
             .carry = carry,
             .tolerance = {tolerance, tolerance},
             .max_steps = 20000};
  in.statistics = &work;
  find_integrator("rkc2")->advance(in);
  double worst = 0;
  for (size_t i = 0; i < y.size(); ++i) {
    worst = std::max(worst, std::abs(y[i] - wave(i) * std::exp(-f.lambda() * t_end)));
  }
  return {worst, work};
}

TEST(Rkc2, EvaluationsGrowWithTheRootOfTheStiffness) {
  double before = 0;
  for (const size_t n : {50, 100, 200, 400}) {
    const auto [error, work] = run(Rod(n, Rod::Radius::given), 0.1, 1e-5);
    std::printf("%zu cells: %lu steps, %lu evaluations, error %.1e\n", n, work.steps, work.rates, error);
    EXPECT_LT(error, 1e-4);
    // The steps are those that the wave's own decay requires; stages double where the stiffness quadruples.
    if (before > 0) {
      EXPECT_NEAR(double(work.rates) / before, 2, 0.4);
    }
    before = double(work.rates);
    // An explicit method of order 5 is limited to 3.3 / stiffness with 6 evaluations per step.
    EXPECT_LT(double(work.rates), 0.1 * 6 * 0.1 * 4 * double(n) * double(n) / 3.3 + 400);
  }
}

TEST(Rkc2, FindsTheSpectralRadiusThatIsNotGiven) {
  const Outcome given = run(Rod(200, Rod::Radius::given), 0.1, 1e-5);
  const Outcome found = run(Rod(200, Rod::Radius::found), 0.1, 1e-5);
  EXPECT_LT(found.error, 2 * given.error + 1e-5);
  // A fifth more radius, a tenth more stages, and the iterations; nothing is trial and error.
  EXPECT_LT(double(found.work.rates), 1.6 * double(given.work.rates));
  EXPECT_LE(found.work.rejected, given.work.rejected + 2);
  // Control: a radius that is too small is detected by the error estimate, which takes many more steps.
  const Outcome wrong = run(Rod(200, Rod::Radius::wrong), 0.1, 1e-5);
  EXPECT_GT(wrong.work.steps + wrong.work.rejected, 5 * given.work.steps);
}

}  // namespace
}  // namespace truestep
