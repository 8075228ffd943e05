// Estimates the cost of a step of an implicit method with direct solves: how often the method evaluates,
// differentiates, factorises and solves, times the cost of each given the pattern of the derivatives. For
// admission only: the number of internal steps of an adaptive method depends on the solution, so its first
// ones are tried if that costs at most 0.15 s, over several steps of the scene; the later half of them
// counts.
#pragma once
#include <optional>

#include "engine/integrators/advance.h"

namespace truestep {

/// Per step (or substep) of a scene; an operation takes a nanosecond, like a multiply-add that depends on the
/// one before.
struct StepWork {
  double rates = 0, jacobians = 0, factorisations = 0, solves = 0;
  double rate = 0, jacobian = 0, factorisation = 0, solve = 0;  ///< operations of one each

  double operations() const {
    return rates * rate + jacobians * jacobian + factorisations * factorisation + solves * solve;
  }
  /// On one core of a current server.
  double seconds() const { return 1e-9 * operations(); }
};

/// Empty for methods that do not use NewtonMatrix. `rate`: operations of one evaluation of f; h (s) is the
/// step's length, y and the tolerance as for `advance`.
std::optional<StepWork> implicit_step_work(const Integrator& method, const RightHandSide& f, double rate,
                                           double h, const double* y, const Tolerance& tolerance);

}  // namespace truestep
