// A scalar carried by a flow in flux form: what leaves a cell through a face enters its neighbour, so that
// the sum over all cells changes only by what crosses open sides. One axis after the other:
//   (room q)' = room q - (out - in),   room' = room - h du/dx,   q' = (room q)' / room',
// room the share of a cell's volume that the axes before have left (1 before the first, and again after the
// last if the flow's divergence is 0): without it each axis alone would squeeze q (Easter 1993, "Two modified
// versions of Bott's positive-definite numerical advection scheme", section 3). What crosses a face is the
// mean, over the length that crosses, of a straight line in the upwind cell; its slope is the monotonized
// central one (van Leer 1977, "Towards the ultimate conservative difference scheme IV", equation 67). While
// no more than a cell's room leaves it, q' lies between values of the cell and its neighbours.
// Axes in turn and then in the opposite order are of second order (Strang 1968). Ghosts must be filled.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// 1/s, the largest share of a cell's volume that leaves it in a second, through all faces together.
double largest_outflow(const MacGrid& grid, const ConstFields& u, const ThreadArena& arena);

/// flux = what crosses each face of an axis in h (s), in cells, towards higher places.
void scalar_flux(const MacGrid& grid, size_t axis, const double* u, double h, const double* q,
                 const double* room, double* flux, const ThreadArena& arena);

/// content (room q) and room after that; q = content / room.
void pass_scalar(const MacGrid& grid, size_t axis, const double* u, double h, const double* flux,
                 double* content, double* room, double* q, const ThreadArena& arena);

}  // namespace truestep::mac
