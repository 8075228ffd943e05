// CVODE of SUNDIALS 6.4 (Hindmarsh et al. 2005; Cohen, Hindmarsh 1996): variable order and step, Adams to
// order 12 or backward differentiation to order 5. The external method for comparison, and the reference of
// studies.
#pragma once
#include <span>
#include <vector>

#include "engine/integrators/advance.h"

namespace truestep {

/// The solution of y' = f(t, y) at t_end from y at t, by CVODE's BDF in one run from start to end. Throws
/// Instability like a method, with CVODE's own message.
std::vector<double> reference_solution(const RightHandSide& f, double t, double t_end,
                                       std::span<const double> y,
                                       const Tolerance& tolerance = {.relative = 1e-12, .absolute = 1e-14});

}  // namespace truestep
