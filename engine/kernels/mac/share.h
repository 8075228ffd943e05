// The share of a cell filled by one of two fluids, with a plane as their border in every mixed cell (PLIC). A
// plane n . x < level cuts a unit cell by the formulas of Scardovelli and Zaleski (2000, "Analytical
// relations connecting linear interfaces and volume fractions in rectangular grids"); its normal follows from
// the sums of three shares along each axis, of which the one most nearly normal to the border decides
// (Aulisa, Manservisi, Scardovelli, Zaleski 2007, "Interface reconstruction with least-squares fit and split
// advection in three-dimensional Cartesian geometry", section 2.2, without Youngs's candidate). Shares are
// advected axis by axis after Weymouth and Yue (2010, "Conservative volume-of-fluid method for free-surface
// simulations on Cartesian-grids", equations 18 to 20): in a divergence-free flow shares stay within 0 and 1
// while less than half a cell is crossed over all axes, and the sum over all cells is conserved to rounding.
// Ghosts must be filled.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// The side of a plane that a fluid fills: normal . x < level, x from 0 to 1 within the cell; the magnitudes
/// of the normal's components add up to 1, or are all 0 if the neighbours show no border.
struct Border {
  std::array<double, 3> normal{};
  double level = 0;
};

/// Share of the unit cell where n . x < level; n of any length, 0 along axes that do not exist.
double share_below(const std::array<double, 3>& normal, double level);
/// The border with this normal (magnitudes adding up to 1) that has this share, from 0 to 1, below it.
Border border_with(const std::array<double, 3>& normal, double share);
/// The border in a cell, from the shares around it.
Border border_in(const MacGrid& grid, const double* share, size_t at);
/// Integral of the place along an axis (0 to 1 within the cell) over what is filled.
double share_moment(const Border& border, size_t axis);
/// Share of the whole cell that is filled between low and high (0 to 1) along an axis.
double share_between(const Border& border, size_t axis, double low, double high);

/// flux = what crosses each face of an axis in h (s), in cells, towards higher places; each cell and its
/// neighbour see the same number.
void share_flux(const MacGrid& grid, size_t axis, const double* u, double h, const double* share,
                double* flux, const ThreadArena& arena);
/// One axis of a step of h (s) with these fluxes. `full` is 1 where the share exceeded a half before the
/// first axis and 0 elsewhere; `swelling` adds up what the axes before have added to `full` cells (0 at
/// first). The last axis takes it back, so that what a pressure solver leaves of divergence moves no volume.
enum class Sweep : uint8_t { inner, last };
void carry_share(const MacGrid& grid, size_t axis, Sweep sweep, const double* u, double h,
                 const double* share, const double* flux, const double* full, double* swelling, double* to,
                 const ThreadArena& arena);

}  // namespace truestep::mac
