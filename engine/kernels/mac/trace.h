// Advection on the staggered grid along paths traced backwards: semi-Lagrangian (Stam 1999, "Stable fluids"),
// MacCormack with a limiter (Selle, Fedkiw, Kim, Liu, Rossignac 2008, "An unconditionally stable MacCormack
// method", section 4), and back and forth error compensation (Kim, Liu, Llamas, Rossignac 2005, "FlowFixer").
// Paths by the midpoint rule, values by linear interpolation. Ghosts must be filled.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// Values next to a point and their weights along each axis, in cells; points beyond the box are moved onto
/// its sides, or to the other end.
double interpolate(const MacGrid& grid, size_t place, const double* u, const double* cells);

struct Limits {
  double low, high;
};
/// Smallest and largest of the values that `interpolate` uses.
Limits limits_around(const MacGrid& grid, size_t place, const double* u, const double* cells);

/// to = `from` (at `place`) transported for h seconds by the flow u. A negative h goes back.
void trace(const MacGrid& grid, size_t place, const ConstFields& u, double h, const double* from, double* to,
           const ThreadArena& arena);
/// MacCormack's correction: to = ahead + (from - back) / 2, limited to the values around the path's start.
void correct(const MacGrid& grid, size_t place, const ConstFields& u, double h, const double* from,
             const double* ahead, const double* back, double* to, const ThreadArena& arena);
/// to = `compensated` transported for h, limited to the values of `from` around the path's start.
void trace_limited(const MacGrid& grid, size_t place, const ConstFields& u, double h, const double* from,
                   const double* compensated, double* to, const ThreadArena& arena);

}  // namespace truestep::mac
