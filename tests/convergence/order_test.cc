// Every row of the integrator table has its promised order, on every problem that it supports.
#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "engine/integrators/explicit/runge_kutta.h"
#include "engine/integrators/table/integrators.h"
#include "tests/convergence/problems.h"

namespace truestep::test {
namespace {

// Halving h must divide the error by 2^order: within 0.1 in the exponent. After extrapolation the next term
// of the error expansion leaves a few hundredths.
constexpr double kOrderTolerance = 0.1;

// Adaptive methods take every step as a whole if no error is too large.
const IntegratorOptions kOptions = {.tolerance = 1e300, .newton_tolerance = 1e-13};

struct Named {
  const char* name;
  Problem (*make)();
};
constexpr Named kProblems[] = {{"oscillator", oscillator},
                               {"damped_oscillator", damped_oscillator},
                               {"kepler", kepler},
                               {"free_body", free_body}};

double order_of(const Integrator& m, const Problem& p, int promised) {
  const auto error = [&](size_t n) { return end_error(m, p, n, kOptions); };
  if (promised >= 6) return fitted_order(error);
  // Low orders converge slowly and need more halvings.
  const size_t first = promised <= 1 ? 1024 : promised == 2 ? 256 : 64;
  return observed_order(error, first, 3);
}

TEST(Order, EveryRowKeepsItsPromise) {
  for (const Named& named : kProblems) {
    const Problem p = named.make();
    for (const Integrator& m : integrators()) {
      if (const auto why = refusal(m, *p.field)) {
        std::printf("%-18s %-22s refused: %s\n", named.name, std::string(m.name).c_str(), why->c_str());
        continue;
      }
      if (m.name.starts_with("cvode")) {
        // Every call starts at order 1 again: such a method promises its tolerance, not an order.
        EXPECT_LT(end_error(m, p, 1, {.tolerance = 1e-10}), 1e-6) << m.name << " on " << named.name;
        continue;
      }
      // Rodas5P's error of order 5 vanishes on linear equations with constant coefficients.
      const bool better = m.name == "rodas5p" && std::string_view(named.name).ends_with("oscillator");
      const int promised = (p.field->dependence() == Dependence::position ? m.order : m.order_with_velocity) +
                           (better ? 1 : 0);
      // Explicit rows of order 5 and more: extended_order_test.cc.
      if (promised >= 5 && m.kind == Integrator::Kind::explicit_) continue;
      const double observed = order_of(m, p, promised);
      std::printf("%-18s %-22s promised %d observed %.3f\n", named.name, std::string(m.name).c_str(),
                  promised, observed);
      EXPECT_NEAR(observed, promised, kOrderTolerance) << m.name << " on " << named.name;
    }
  }
}

TEST(Order, AMutatedTableauFails) {
  // The last two weights of rk4 exchanged: they still sum to 1.
  static const Tableau kWrong = [] {
    Tableau t = kRk4Tableau;
    std::swap(t.b[2], t.b[3]);
    return t;
  }();
  Integrator wrong = *find_integrator("rk4");
  wrong.step = [](const ForceField& field, State& state, const StepInput& in, const IntegratorOptions&) {
    Motion m(field, state, in);
    RungeKutta(kWrong, m).step(in.t, in.h, m.x, m.v, m.x, m.v);
  };
  for (const Named& named : kProblems) {
    EXPECT_LT(order_of(wrong, named.make(), 4), 4 - kOrderTolerance) << named.name;
  }
}

TEST(Order, AdaptiveErrorsFollowTheTolerance) {
  // Ten times the tolerance may give at most some ten times the error: proportionality within a factor of 4.
  const Problem p = kepler();
  for (const char* name : {"step_doubling", "dopri5"}) {
    const Integrator& m = *find_integrator(name);
    const double coarse = end_error(m, p, 5, {.tolerance = 1e-6}),
                 fine = end_error(m, p, 5, {.tolerance = 1e-9});
    EXPECT_LT(coarse, 1e-4) << name;
    EXPECT_LT(fine, coarse / 30) << name;
    // Control: without error control five steps are far off.
    EXPECT_GT(end_error(m, p, 5, kOptions), 1e-3) << name;
  }
}

}  // namespace
}  // namespace truestep::test
