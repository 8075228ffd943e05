// Lines along a vector field on a plane lattice, x' = v(x) / |v(x)|, by the classical Runge-Kutta method on
// the bilinear interpolant.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace truestep {

/// nx x ny vectors (u, v) in lattice units, x fastest.
struct PlaneField {
  std::span<const float> u, v;
  size_t nx = 0, ny = 0;
  double margin = 0;  ///< how far the field goes on beyond its outermost vectors, with their values

  /// Direction at a position inside; (0, 0) outside or where the field vanishes or is not finite.
  std::array<double, 2> direction(double x, double y) const {
    const double last_x = static_cast<double>(nx - 1), last_y = static_cast<double>(ny - 1);
    if (!(x >= -margin && y >= -margin && x <= last_x + margin && y <= last_y + margin)) return {0, 0};
    x = std::clamp(x, 0.0, last_x), y = std::clamp(y, 0.0, last_y);
    const size_t i = std::min(static_cast<size_t>(x), nx - 2), j = std::min(static_cast<size_t>(y), ny - 2);
    const double s = x - static_cast<double>(i), t = y - static_cast<double>(j);
    const auto at = [&](std::span<const float> f) {
      const size_t k = i + nx * j;
      return (1 - t) * ((1 - s) * f[k] + s * f[k + 1]) + t * ((1 - s) * f[k + nx] + s * f[k + nx + 1]);
    };
    const double a = at(u), b = at(v), size = std::sqrt(a * a + b * b);
    if (!(size > 0) || !std::isfinite(size)) return {0, 0};
    return {a / size, b / size};
  }
};

/// The line through (x, y) along the field (h > 0) or against it (h < 0), in steps of |h| lattice units:
/// until it leaves, stops or has `most` points.
inline std::vector<std::array<double, 2>> streamline(const PlaneField& field, double x, double y, double h,
                                                     size_t most) {
  std::vector<std::array<double, 2>> out{{x, y}};
  const auto stands = [](const std::array<double, 2>& d) { return d[0] == 0 && d[1] == 0; };
  while (out.size() < most) {
    const auto k1 = field.direction(x, y);
    const auto k2 = field.direction(x + 0.5 * h * k1[0], y + 0.5 * h * k1[1]);
    const auto k3 = field.direction(x + 0.5 * h * k2[0], y + 0.5 * h * k2[1]);
    const auto k4 = field.direction(x + h * k3[0], y + h * k3[1]);
    if (stands(k1) || stands(k2) || stands(k3) || stands(k4)) break;
    x += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]);
    y += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]);
    out.push_back({x, y});
  }
  return out;
}

}  // namespace truestep
