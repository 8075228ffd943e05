#include "engine/integrators/control/step_work.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/integrators/implicit/newton_matrix.h"

namespace truestep {

namespace {

/// Work per internal step, as counted on diffusion with a reaction on a grid of 20 x 20 points at a tolerance
/// of 1e-6; and the number of internal steps relative to a second-order method.
struct Habits {
  std::string_view method;
  double rates, jacobians, factorisations, solves, steps = 1;
};
constexpr Habits kHabits[] = {
    {"implicit_midpoint", 5, 1, 1, 5},
    {"trapezoid", 5, 1, 1, 5},
    {"bdf2", 5, 1, 1, 5},
    {"newmark", 5, 1, 1, 5},
    {"generalized_alpha", 5, 1, 1, 5},
    {"tr_bdf2", 4.1, 0.1, 0.5, 5},
    {"sdirk4", 10.7, 0.2, 0.6, 11.5, 0.5},
    {"rodas5p", 8.7, 1, 1, 8, 0.25},
    {"radau5", 6.5, 0.2, 0.6, 3, 0.45},
    {"cvode_bdf", 2, 0.1, 0.2, 1.6, 1},
};

/// Internal steps of an adaptive method: as many as the first step's length suggests, but no more than it
/// takes to grow from that to the whole step by a factor per step.
double internal_steps(const RightHandSide& f, double h, const double* y, const Tolerance& tolerance) {
  const size_t n = f.size();
  std::vector<double> rate(n);
  f.rate(0, y, rate.data());
  // Length over which the solution changes by the cube root of the tolerance: typical step of a second-order
  // method.
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
  const double steps = method.stepping == Integrator::Stepping::adaptive
                           ? std::max(1.0, habits->steps * internal_steps(f, h, y, tolerance))
                           : 1;
  StepWork w;
  w.rates = steps * habits->rates, w.jacobians = steps * habits->jacobians;
  w.factorisations = steps * habits->factorisations, w.solves = steps * habits->solves;
  w.rate = rate + static_cast<double>(f.size());
  w.jacobian = matrix.jacobian_work(rate);
  const FactorWork each = matrix.factor_work();
  // radau5 factorises and solves with one real and one complex matrix.
  const double complex = method.name == "radau5" ? 2.5 : 1;
  w.factorisation = complex * each.factor, w.solve = complex * each.solve;
  return w;
}

}  // namespace truestep
