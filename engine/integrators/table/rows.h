// The families of the table of methods, in the order in which users see them: one file rows_FAMILY.cc each.
// Stability limits are the roots of each method's stability polynomial on the imaginary and the negative real
// axis; tests verify them by bisection on a real field.
#pragma once
#include <span>

#include "engine/core/equations/integrator.h"

namespace truestep {

std::span<const Integrator> classical_rows();
std::span<const Integrator> composition_rows();
std::span<const Integrator> runge_kutta_rows();
std::span<const Integrator> second_order_rows();
std::span<const Integrator> implicit_rows();
std::span<const Integrator> stiff_rows();
std::span<const Integrator> descent_rows();
std::span<const Integrator> cvode_rows();

}  // namespace truestep
