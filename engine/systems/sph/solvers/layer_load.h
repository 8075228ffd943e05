// The depth of a liquid, and how hard the weight of denser liquid presses on lighter liquid below it:
// pressure p on particles of density rho holds a lattice of them in place like springs of frequency sqrt(p /
// rho) / spacing, which substeps must resolve. In a single liquid p / rho is g times the depth; under a
// denser one it is larger by the ratio of the densities.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

/// m, depth of a pool with this liquid's mean depth: in a pool above its lowest particle, the mean square
/// of the height is a third of the squared depth. `place` is n x 3, `down` a unit vector, `partial` scratch.
template <int D, class T>
double depth(const T* place, size_t n, const Vec3& down, std::vector<double>& partial,
             const ThreadArena& arena) {
  const double axis[3] = {down.x, down.y, down.z};
  const size_t blocks = (n + kBlockRows - 1) / kBlockRows;
  partial.assign(3 * blocks, 0);
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double low = HUGE_VAL, sum = 0, squares = 0;
    for (size_t i = begin; i < end; ++i) {
      double height = 0;
      for (size_t a = 0; a < D; ++a) height -= axis[a] * double{place[3 * i + a]};
      low = std::min(low, height), sum += height, squares += height * height;
    }
    double* out = partial.data() + 3 * (begin / kBlockRows);
    out[0] = low, out[1] = sum, out[2] = squares;
  });
  double low = HUGE_VAL, sum = 0, squares = 0;
  for (size_t k = 0; k < blocks; ++k) {
    low = std::min(low, partial[3 * k]), sum += partial[3 * k + 1], squares += partial[3 * k + 2];
  }
  if (n == 0) return 0;
  const double count = static_cast<double>(n);
  return std::sqrt(3 * std::max((squares - 2 * low * sum) / count + low * low, 0.0));
}

/// m^2/s^2, the largest pressure over its own density of any particle, by the last solves of dfsph.
template <class T>
double load_of_pressures(const T* push, const T* flow, const T* ratio, size_t n, std::vector<double>& partial,
                         const ThreadArena& arena) {
  partial.assign((n + kBlockRows - 1) / kBlockRows, 0);
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double most = 0;
    for (size_t k = begin; k < end; ++k) most = std::max(most, double{flow[k] + push[k]} / double{ratio[k]});
    partial[begin / kBlockRows] = most;
  });
  double most = 0;
  for (const double part : partial) most = std::max(most, part);
  return most;
}

/// m^2/s^2, the largest p / rho of liquid at rest in horizontal layers one spacing thick: what is above a
/// layer rests on it evenly. `ratio` and `place` (n x 3) are the state's columns, `layers` is scratch.
template <int D, class T>
double load_by_weight(const Setting& set, const T* place, const T* ratio, size_t n, const Vec3& gravity,
                      std::vector<double>& layers) {
  const SphDef& d = set.def;
  const double g = norm(gravity), up[3] = {-gravity.x / g, -gravity.y / g, -gravity.z / g};
  const double lows[3] = {d.low.x, d.low.y, d.low.z}, highs[3] = {d.high.x, d.high.y, d.high.z};
  double low = 0, high = 0;
  for (size_t a = 0; a < D; ++a) {
    low += std::min(up[a] * lows[a], up[a] * highs[a]), high += std::max(up[a] * lows[a], up[a] * highs[a]);
  }
  const double per_layer = 1 / d.spacing;
  const auto count = static_cast<size_t>(std::max((high - low) * per_layer, 0.0)) + 1;
  // Of each layer: particles, sum of their densities and the least of them, over the system's.
  layers.assign(3 * count, 0);
  for (size_t i = 0; i < n; ++i) {
    double height = -low;
    for (size_t a = 0; a < D; ++a) height += up[a] * double{place[3 * i + a]};
    const double k = std::clamp(height * per_layer, 0.0, static_cast<double>(count - 1));
    double* layer = layers.data() + 3 * static_cast<size_t>(k);
    const double own = double{ratio[i]};
    layer[2] = layer[0] > 0 ? std::min(layer[2], own) : own;
    layer[0] += 1, layer[1] += own;
  }
  double above = 0, most = 0;
  for (size_t k = count; k-- > 0;) {
    const double* layer = layers.data() + 3 * k;
    if (!(layer[0] > 0)) continue;
    above += layer[1];
    most = std::max(most, g * d.spacing * above / (layer[0] * layer[2]));
  }
  return most;
}

}  // namespace truestep::sph
