#include "engine/integrators/step_work.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/integrators/newton_matrix.h"

namespace truestep {

namespace {

/// What an internal step does, as counted on the scenes of tests/unit/step_work_test.cc.
struct Habits {
  std::string_view method;
  double rates, jacobians, factorisations, solves;
};
constexpr Habits kHabits[] = {
    {"implicit_midpoint", 4, 1, 1, 4}, {"trapezoid", 5, 1, 1, 4},         {"bdf2", 4, 1, 1, 4},
    {"newmark", 4, 1, 1, 4},           {"generalized_alpha", 4, 1, 1, 4}, {"tr_bdf2", 6, 0.5, 0.7, 7},
    {"sdirk4", 14, 0.5, 0.7, 15},      {"rodas5p", 9, 1, 1, 8},           {"radau5", 9, 0.5, 1.2, 5},
    {"cvode_bdf", 2, 0.1, 0.2, 1.6},
};

/// Internal steps of an adaptive method: as many as the first step's length suggests, but no more than it
/// takes to grow from that to the whole by a factor per step.
double internal_steps(const RightHandSide& f, double h, const double* y, const Tolerance& tolerance) {
  const size_t n = f.size();
  std::vector<double> rate(n);
  f.rate(0, y, rate.data());
  // Length over which the solution changes by the cube root of the tolerance: what a method of second order
  // likes.
  double fastest = 0;
  for (size_t i = 0; i < n; ++i) {
    const double size = std::max(std::abs(y[i]), tolerance.absolute / std::max(tolerance.relative, 1e-12));
    if (size > 0) fastest = std::max(fastest, std::abs(rate[i]) / size);
  }
  const double liked = 0.1 / std::max(fastest, 1e-300);
  const double ratio = h / liked;
  return ratio <= 1 ? 1 : std::min(ratio, 3 + 4 * std::log10(ratio));
}

}  // namespace

std::optional<StepWork> implicit_step_work(const Integrator& method, const RightHandSide& f, double rate,
                                           double h, const double* y, const Tolerance& tolerance) {
  const auto* habits = std::find_if(std::begin(kHabits), std::end(kHabits),
                                    [&](const Habits& k) { return k.method == method.name; });
  if (habits == std::end(kHabits) || f.size() == 0) return std::nullopt;
  NewtonMatrix matrix;
  matrix.bind(f);
  const double steps =
      method.stepping == Integrator::Stepping::adaptive ? internal_steps(f, h, y, tolerance) : 1;
  StepWork w;
  w.rates = steps * habits->rates, w.jacobians = steps * habits->jacobians;
  w.factorisations = steps * habits->factorisations, w.solves = steps * habits->solves;
  w.rate = rate + static_cast<double>(f.size());
  w.jacobian = matrix.jacobian_work(rate);
  const FactorWork each = matrix.factor_work();
  // radau5 factorises one real and one complex matrix, and so it solves.
  const double complex = method.name == "radau5" ? 2.5 : 1;
  w.factorisation = complex * each.factor, w.solve = complex * each.solve;
  return w;
}

}  // namespace truestep
