// The staggered grid of Harlow and Welch (1965, "Numerical calculation of time-dependent viscous
// incompressible flow of fluid with free surface") on a box: each component of velocity is at the faces
// perpendicular to its axis, pressure and scalars are at the cells' centres. All arrays have the same padded
// shape and strides: place (i, j, k) of a component is its face or cell i, j, k, from -kGhosts to cells +
// kGhosts along every axis of the grid; face i is i spacings from the lower side, cell i at i + 1/2.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/math/vec3.h"

namespace truestep::mac {

inline constexpr size_t kGhosts = 2;
/// The place of values at cell centres; 0, 1, 2 are faces along the axes.
inline constexpr size_t kCentre = 3;

struct MacGrid {
  size_t dimensions = 2;
  std::array<size_t, 3> cells{1, 1, 1};
  std::array<double, 3> spacing{1, 1, 1};  ///< m
  std::array<double, 3> origin{};          ///< m, lower corner
  std::array<bool, 3> periodic{};

  size_t padded(size_t a) const { return a < dimensions ? cells[a] + 2 * kGhosts + 1 : 1; }
  size_t size() const { return padded(0) * padded(1) * padded(2); }
  size_t stride(size_t a) const { return a == 0 ? 1 : a == 1 ? padded(0) : padded(0) * padded(1); }
  /// Of place (0, 0, 0).
  size_t base() const {
    size_t b = 0;
    for (size_t a = 0; a < dimensions; ++a) b += kGhosts * stride(a);
    return b;
  }
  size_t at(size_t i, size_t j, size_t k) const { return base() + i + stride(1) * j + stride(2) * k; }
  size_t cell_count() const { return cells[0] * cells[1] * cells[2]; }
  /// Number of independent values of `place` along axis a: a periodic axis has as many faces as cells.
  size_t count(size_t place, size_t a) const {
    return a < dimensions && place == a && !periodic[a] ? cells[a] + 1 : cells[a];
  }
  /// m, of value i of `place` along axis a.
  double coordinate(size_t place, size_t a, double i) const {
    if (a >= dimensions) return 0;
    return origin[a] + spacing[a] * (place == a ? i : i + 0.5);
  }
  /// m, of the value of `place` at an offset.
  Vec3 position(size_t place, size_t at) const {
    double x[3] = {};
    for (size_t a = dimensions; a-- > 0;) {
      const size_t padded = at / stride(a);
      at -= padded * stride(a);
      x[a] = coordinate(place, a, static_cast<double>(padded) - static_cast<double>(kGhosts));
    }
    return {x[0], x[1], x[2]};
  }
  double cell_volume() const {
    double v = 1;
    for (size_t a = 0; a < dimensions; ++a) v *= spacing[a];
    return v;
  }
  double extent(size_t a) const { return spacing[a] * static_cast<double>(cells[a]); }
};

}  // namespace truestep::mac
