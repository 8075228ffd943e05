// Positions in a lattice: the surrounding rows and their weights for multilinear interpolation.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/part.h"

namespace truestep {

struct LatticePlace {
  size_t rows[8];
  double weights[8];  ///< their sum is 1
};

/// Empty for a position outside. Between the outermost cell centres and the grid's edge, the edge row is
/// used.
inline std::optional<LatticePlace> locate(const Lattice& l, const Vec3& at) {
  const double place[3] = {at.x, at.y, at.z}, origin[3] = {l.origin.x, l.origin.y, l.origin.z},
               spacing[3] = {l.spacing.x, l.spacing.y, l.spacing.z};
  const double margin = l.centring == Lattice::Centring::cells ? 0.5 : 0;
  size_t low[3], high[3];
  double share[3];
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t n = l.counts[axis];
    low[axis] = high[axis] = 0, share[axis] = 0;
    if (n == 1) continue;
    const double last = static_cast<double>(n - 1), u = (place[axis] - origin[axis]) / spacing[axis];
    constexpr double kRounding = 1e-9;  // a position on the edge counts as inside
    if (!(u >= -margin - kRounding && u <= last + margin + kRounding)) return std::nullopt;
    const double inside = std::clamp(u, 0.0, last);
    low[axis] = std::min(static_cast<size_t>(inside), n - 2);
    high[axis] = low[axis] + 1;
    share[axis] = inside - static_cast<double>(low[axis]);
  }
  LatticePlace out;
  for (size_t k = 0; k < 8; ++k) {
    const bool up[3] = {(k & 1) != 0, (k & 2) != 0, (k & 4) != 0};
    const auto index = [&](size_t axis) { return up[axis] ? high[axis] : low[axis]; };
    out.rows[k] = index(0) + l.counts[0] * (index(1) + size_t{l.counts[1]} * index(2));
    out.weights[k] = 1;
    for (size_t axis = 0; axis < 3; ++axis) out.weights[k] *= up[axis] ? share[axis] : 1 - share[axis];
  }
  return out;
}

}  // namespace truestep
