// Convection on the staggered grid in advective form by upwind differences of first order (Courant, Isaacson,
// Rees 1952, "On the solution of nonlinear hyperbolic differential equations by finite differences"): no new
// extremes, whatever the densities at a face, while central differences of velocity alone feed the lighter of
// two fluids with energy from the heavier one.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// m/s^2, -u . grad u_c + viscosity lap u_c at a face of component c. Ghosts must be filled.
double upwind_rate(const MacGrid& grid, size_t c, const ConstFields& u, double viscosity, size_t at);

}  // namespace truestep::mac
