// The surface of a liquid whose particles are spread on the cells of a staggered grid. A cell's fill is the
// sum of the particles' linear weights over that of liquid at rest; if a level surface lies depth cells above
// a cell's centre the fill is
//   (1 + depth)^2 / 2 below 1/2,   1 - (1 - depth)^2 / 2 above,
// so the surface (depth 0) is where the fill is a half. The pressure is 0 at the surface itself, not at the
// next centre beyond it (Gibou, Fedkiw, Cheng, Kang 2002, "A second-order-accurate symmetric
// discretization of the Poisson equation on irregular domains"; Enright et al. 2003, "Using the particle
// level set method and a second order accurate pressure boundary condition for free surface flows").
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/base/parallel.h"
#include "engine/kernels/mac/mac_grid.h"
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// Cells of liquid above a centre, in [-1, 1], from its fill.
inline double depth_of_fill(double fill) {
  if (fill < 0.5) return std::sqrt(2 * std::max(fill, 0.0)) - 1;
  return 1 - std::sqrt(2 * std::max(1 - fill, 0.0));
}

/// 1 / the fraction of the distance between two centres that lies in the liquid; at most 1e6, so that it
/// stays finite when the surface passes through a centre.
inline double surface_factor(double depth_inside, double depth_outside) {
  constexpr double kLeast = 1e-6;
  const double share = depth_inside / (depth_inside - depth_outside);
  return 1 / std::max(share, kLeast);
}

/// Weight of the pressure difference at each face: 1 between cells of liquid, surface_factor at the surface,
/// 0 elsewhere and on the box's sides. `liquid` and `depth` are cell values, wrapped if the grid is periodic.
void surface_faces(const MacGrid& grid, size_t component, const uint8_t* liquid, const double* depth,
                   double* factor, const ThreadArena& arena);

/// Gives unknown faces the mean of their known neighbours and marks them known, `layers` times outwards;
/// `found` and `fresh` are scratch of the grid's size.
void extrapolate(const MacGrid& grid, size_t component, int layers, double* u, uint8_t* known, double* found,
                 uint8_t* fresh, const ThreadArena& arena);

/// Copies values to the other end of periodic axes.
template <class T>
void wrap_periodic(const MacGrid& g, T* u, const ThreadArena& arena) {
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (!g.periodic[a]) continue;
    const size_t s = g.stride(a), n = g.cells[a];
    for_lines(g, a, arena, [=](size_t at) {
      T* line = u + at;
      for (size_t m = 0; m < kGhosts; ++m) line[m * s] = line[(n + m) * s];
      for (size_t m = 0; m <= kGhosts; ++m) line[(kGhosts + n + m) * s] = line[(kGhosts + m) * s];
    });
  }
}

/// Adds what was spread beyond the ends of periodic axes to the values it belongs to.
void fold_periodic(const MacGrid& grid, double* u, const ThreadArena& arena);

/// The same for cell values, and what was spread beyond the box's sides is added to the cells beside them, so
/// that no particle counts less for being close to a side: where particles kept off sides, fewer of them
/// would fill the cells there.
void fold_cells(const MacGrid& grid, double* cells, const ThreadArena& arena);

}  // namespace truestep::mac
