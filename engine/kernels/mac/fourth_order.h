// Differences of fourth order on the staggered grid, for smooth flows in boxes with periodic or slip sides:
//   (df/dx) between values  = 9/8 (f1 - f0) / dx - 1/8 (f2 - f_1) / (3 dx)
//   (df/dx) at a value      = (8 (f1 - f_1) - (f2 - f_2)) / (12 dx)
//   (d2f/dx2) at a value    = (16 (f1 + f_1) - 30 f0 - (f2 + f_2)) / (12 dx^2)
//   f between values        = 9/16 (f0 + f1) - 1/16 (f_1 + f2)
// (Morinishi, Lund, Vasilyev, Moin 1998, "Fully conservative higher order finite difference schemes for
// incompressible flow", section 2.2; Fornberg 1988). Convection in advective form: their divergence form
// conserves energy and reaches three values to each side, this one reaches two and conserves it to fourth
// order. Ghosts must be filled.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// Like momentum_rate, add_laplacian, divergence and subtract_gradient.
void momentum_rate4(const MacGrid& grid, size_t c, const ConstFields& u, double viscosity, double* out,
                    const ThreadArena& arena);
void add_laplacian4(const MacGrid& grid, size_t place, const double* u, double factor, double* out,
                    const ThreadArena& arena);
void divergence4(const MacGrid& grid, const ConstFields& u, double* out, const ThreadArena& arena);
void subtract_gradient4(const MacGrid& grid, size_t c, const double* p, double factor, double* u,
                        const ThreadArena& arena);
/// out = the flow through the faces of component c (m/s) of which divergence4 is the difference of second
/// order: 9/8 u1 - (u0 + u1 + u2) / 24.
void flow_through4(const MacGrid& grid, size_t c, const double* u, double* out, const ThreadArena& arena);
/// Divergence of the cell at an offset, for callers that need single cells.
double divergence4_at(const MacGrid& grid, const ConstFields& u, size_t at);

}  // namespace truestep::mac
