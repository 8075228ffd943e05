// Points and directions from uniform numbers in [0, 1), and regular arrangements.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::particles {

inline constexpr double kTurn = 6.283185307179586;

/// Two unit vectors perpendicular to the unit vector n (Duff et al. 2017, "Building an orthonormal basis").
inline void orthonormal_basis(const Vec3& n, Vec3& a, Vec3& b) {
  const double sign = n.z < 0 ? -1 : 1, p = -1 / (sign + n.z), q = n.x * n.y * p;
  a = {1 + sign * n.x * n.x * p, sign * q, -sign * n.x};
  b = {q, sign + n.y * n.y * p, -n.y};
}

/// Direction within `cone` (rad) of the unit vector `axis`, uniform in solid angle.
inline Vec3 direction_in_cone(const Vec3& axis, double cone, double u, double w) {
  const double c = 1 - u * (1 - trig::cos(cone)), s = std::sqrt(std::max(0.0, 1 - c * c));
  const trig::SinCos phi = trig::sincos(kTurn * w);
  Vec3 a, b;
  orthonormal_basis(axis, a, b);
  return axis * c + a * (s * phi.cos) + b * (s * phi.sin);
}

/// Uniform in the unit ball.
inline Vec3 point_in_ball(const std::array<double, 4>& u) {
  const double c = 2 * u[0] - 1, s = std::sqrt(std::max(0.0, 1 - c * c)), r = trig::pow(u[2], 1.0 / 3);
  const trig::SinCos phi = trig::sincos(kTurn * u[1]);
  return Vec3{s * phi.cos, c, s * phi.sin} * r;
}

/// Uniform in the unit disk perpendicular to the unit vector `axis`.
inline Vec3 point_in_disk(const Vec3& axis, double u, double w) {
  const trig::SinCos phi = trig::sincos(kTurn * w);
  const double r = std::sqrt(u);
  Vec3 a, b;
  orthonormal_basis(axis, a, b);
  return a * (r * phi.cos) + b * (r * phi.sin);
}

/// Points per axis of a box lattice with at least `count` points, spaced as evenly as possible on all axes.
struct LatticeShape {
  size_t nx = 1, ny = 1, nz = 1;
};
inline LatticeShape lattice_shape(size_t count, const Vec3& half) {
  const double volume = half.x * half.y * half.z, n = static_cast<double>(count);
  const auto at_least_one = [](double v) { return static_cast<size_t>(std::clamp(v, 1.0, 1e7)); };
  if (!(volume > 0)) {
    // A sheet or a line: spread over the axes that have an extent.
    const int axes = (half.x > 0) + (half.y > 0) + (half.z > 0);
    const size_t side = axes == 2 ? at_least_one(std::ceil(std::sqrt(n))) : count;
    LatticeShape s;
    size_t left = count;
    for (auto [e, out] : {std::pair{half.x, &s.nx}, std::pair{half.y, &s.ny}, std::pair{half.z, &s.nz}}) {
      if (!(e > 0)) continue;
      *out = std::min(side, std::max<size_t>(left, 1));
      left = (left + *out - 1) / *out;
    }
    return s;
  }
  const double spacing = trig::pow(volume / n, 1.0 / 3);
  LatticeShape s{at_least_one(half.x / spacing + 0.5), at_least_one(half.y / spacing + 0.5), 1};
  s.nz = (count + s.nx * s.ny - 1) / (s.nx * s.ny);
  return s;
}
/// Point i of the lattice, cells centred in the box of half extents `half`.
inline Vec3 lattice_point(const LatticeShape& s, size_t i, const Vec3& half) {
  const auto place = [](size_t k, size_t n, double h) {
    return h * (2 * (static_cast<double>(k) + 0.5) / static_cast<double>(n) - 1);
  };
  return {place(i % s.nx, s.nx, half.x), place(i / s.nx % s.ny, s.ny, half.y),
          place(i / (s.nx * s.ny), s.nz, half.z)};
}

/// Point i of `count` spread evenly through the unit ball (golden-angle spiral, radius by volume).
inline Vec3 ball_spiral_point(size_t i, size_t count) {
  const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  // The direction sequence must not follow the radius: the height uses another irrational step.
  const double height = 0.5 + static_cast<double>(i) * 0.7548776662466927;
  const double c = 2 * (height - std::floor(height)) - 1, s = std::sqrt(std::max(0.0, 1 - c * c));
  const trig::SinCos phi = trig::sincos(kTurn * std::fmod(static_cast<double>(i) * 0.5698402909980532, 1.0));
  return Vec3{s * phi.cos, c, s * phi.sin} * trig::pow(u, 1.0 / 3);
}

}  // namespace truestep::particles
