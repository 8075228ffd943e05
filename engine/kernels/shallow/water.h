// The shallow water equations on the cells of a box of one or two dimensions,
//   h_t + div(h u) = 0,   (h u)_t + div(h u u) + grad(g h^2 / 2) = -g h grad z,
// h depth, u velocity, z bed (m), by second-order finite volumes that keep a lake at rest and depths
// non-negative, wet or dry: surface, depth and velocity are extrapolated to the faces with van Leer's limited
// slopes (1977, "Towards the ultimate conservative difference scheme. IV"), depths there are measured above
// the higher of both beds (Audusse et al. 2004, "A fast and stable well-balanced scheme with hydrostatic
// reconstruction for shallow water flows"), fluxes are those of Harten, Lax, van Leer with the contact wave
// upwinded (Toro 2001, "Shock-capturing methods for free-surface shallow flows", section 10.4).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/parallel.h"

namespace truestep::shallow {

/// The condition on a side: the water is reflected, flows out with zero gradient, or re-enters at the other
/// end.
enum class Edge : uint8_t { wall, open, periodic };

struct Basin {
  size_t dimensions = 2;
  std::array<size_t, 2> cells{1, 1};
  std::array<double, 2> spacing{1, 1}, origin{};  ///< m
  std::array<std::array<Edge, 2>, 2> edges{};     ///< [axis][low, high]
  double gravity = 9.81;                          ///< m/s^2
  double dry = 1e-6;                              ///< m, depth below which water is at rest

  static constexpr size_t kGhosts = 2;
  size_t count() const { return cells[0] * cells[1]; }
  size_t row() const { return cells[0] + 2 * kGhosts; }
  size_t padded() const { return row() * (cells[1] + (dimensions == 2 ? 2 * kGhosts : 0)); }
  /// Index of cell i, j in the padded arrays.
  size_t at(size_t i, size_t j) const { return i + kGhosts + row() * (j + (dimensions == 2 ? kGhosts : 0)); }
  double centre(size_t axis, size_t i) const {
    return origin[axis] + spacing[axis] * (static_cast<double>(i) + 0.5);
  }
  double cell_area() const { return spacing[0] * (dimensions == 2 ? spacing[1] : 1); }
};

/// Depth (m) and discharges (m^2/s) of the cells, x running fastest; a one-dimensional basin has no qy.
struct Water {
  double *h = nullptr, *qx = nullptr, *qy = nullptr;
};

/// Bed, depth, surface, velocity with two cells beyond every side.
struct Primitives {
  std::vector<double> z, h, eta, u, v;
};

/// Fills values beyond the sides; `normal_axis` is the axis along which a wall reverses them, 2: none.
void fill_edges(const Basin& basin, size_t normal_axis, double* padded);

/// p from water; p.z with its ghosts must be there. Velocity is 0 where the depth is at most `dry`.
void primitives(const Basin& basin, const Water& water, Primitives& p, const ThreadArena& arena);

/// Rates of h, qx, qy (per s). Returns the cells per second crossed by the fastest wave, summed over the
/// axes: depths stay positive in Euler steps of half its inverse. `row_speeds` has two values per row.
double rates(const Basin& basin, const Primitives& p, const Water& out, double* row_speeds,
             const ThreadArena& arena);

}  // namespace truestep::shallow
