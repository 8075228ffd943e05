// Momentum of two fluids carried by the fluxes of mass that carry their border (Rudman 1998, "A
// volume-tracking method for incompressible multifluid flows with large density variations", section 2.4):
// along each axis of a step
//   (density u)' = density u - d(mass flux u_behind),   u' = (density u)' / density',
// so that the heavier fluid hands the lighter one no more than passes between them. The mass of a face's
// volume is the mean of the cells beside it and its fluxes are means of theirs, which keeps both in step
// without Rudman's grid of half the spacing. Values on the sides of a volume are the upwind ones, of first
// order.
#pragma once
#include "engine/kernels/mac/share.h"

namespace truestep::mac {

/// kg/m^3, of the fluid that fills the rest of a cell, and of the one whose share is carried.
struct TwoDensities {
  double first = 1, second = 1;
  double of(double share) const { return first + share * (second - first); }
};

/// flux (of the share through faces of an axis) becomes that of mass: kg/m^3 times cells, towards higher
/// places. Faces without neighbours inside are left alone.
void mass_flux(const MacGrid& grid, size_t axis, const double* u, double h, const TwoDensities& densities,
               double* flux, const ThreadArena& arena);
/// Advances component c of a velocity q by a step of h along an axis: to = q'. `mass` are the fluxes along
/// that axis, u what crosses faces, `share` and `full` as in carry_share before the axis; ghosts of q, mass,
/// share and full must be filled.
void carry_momentum(const MacGrid& grid, size_t c, size_t axis, Sweep sweep, const ConstFields& u, double h,
                    const TwoDensities& densities, const double* share, const double* full,
                    const double* mass, const double* q, double* to, const ThreadArena& arena);
/// Whether the fluids beside a face of component c, or beside one next to it, are not of one density.
bool beside_border(const MacGrid& grid, size_t c, const double* share, size_t at);

}  // namespace truestep::mac
