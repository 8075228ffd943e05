// Viscous stress of fluids whose viscosity changes from cell to cell, of second order on the staggered grid:
//   du_c/dt = 1/density sum over a of d/dx_a [ m (du_c/dx_a + du_a/dx_c) ].
// On the sides of a face's volume m is the harmonic mean of the cells around (Patankar 1980, "Numerical heat
// transfer and fluid flow", section 4.2-3), which makes the stress of layers that slide over each other exact
// where their border lies on faces. Where m is the same everywhere it is the Laplacian of a flow without
// divergence.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// rate += the stress on faces of component c (m/s^2). `fluidity` is 1 / m of cells (1/(Pa s); infinite: no
/// stress), `lightness` `density` by the density of a face (density in kg/m^3). Ghosts must be filled.
void add_stress(const MacGrid& grid, size_t c, const ConstFields& u, const double* fluidity,
                const double* lightness, double density, double* rate, const ThreadArena& arena);

}  // namespace truestep::mac
