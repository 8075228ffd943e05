// One spring between points a and b, with d = x_b - x_a, l = |d|, w = v_b - v_a, n = d / l:
//   force on a   f = k (1 - L / l) d + c (w . n) n     (the force on b is -f)
//   energy       V = k/2 (l - L)^2
//   df/dx_b      K = k ((1 - L / l)(I - n n^T) + n n^T),  df/dv_b = c n n^T
// Baraff & Witkin, "Large Steps in Cloth Simulation" (1998), sections 2 and 4. The derivative of the damping
// force by position is left out of K: it is not symmetric and vanishes with h. Coincident points (l = 0) have
// no direction: a rest length or damping then contributes no force, and K is k I.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/math/vec3.h"

namespace truestep::spring {

/// Energy in J.
inline double energy(double length, double k, double rest) {
  return 0.5 * k * (length - rest) * (length - rest);
}

/// Force on a in N.
inline Vec3 force(const Vec3& d, const Vec3& w, double k, double rest, double c) {
  const double l2 = norm2(d), l = std::sqrt(l2);
  const double inv = l2 > 0 ? 1 / l : 0;
  return (k * (1 - rest * inv) + c * dot(w, d) * (inv * inv)) * d;
}

/// Dissipation function R (W) of the damping force: c/2 (w . n)^2.
inline double dissipation(const Vec3& d, const Vec3& w, double c) {
  const double l2 = norm2(d), wd = dot(w, d);
  return l2 > 0 ? 0.5 * c * wd * wd / l2 : 0;
}

/// K = alpha I + beta d d^T (N/m and N/m^3).
struct Stiffness {
  double alpha, beta;
};
inline Stiffness stiffness(double l2, double k, double rest) {
  const double inv = l2 > 0 ? 1 / std::sqrt(l2) : 0;
  return {k * (1 - rest * inv), k * rest * inv * (inv * inv)};
}

/// K without the transverse term of a compressed spring, so that -df/dx is positive semidefinite (Choi, Ko
/// 2002, "Stable but responsive cloth", section 4).
inline Stiffness definite_stiffness(double l2, double k, double rest) {
  const Stiffness exact = stiffness(l2, k, rest);
  return exact.alpha >= 0 ? exact : Stiffness{0, l2 > 0 ? k / l2 : 0};
}

inline constexpr size_t kRunChunk = 128;

/// Forces of n <= kRunChunk springs from their end-to-end differences, in place: (dx, dy, dz) becomes the
/// force on a. `scale` multiplies the family's stiffness k.
inline void run_forces(size_t n, double* __restrict dx, double* __restrict dy, double* __restrict dz,
                       const double* __restrict rest, const double* __restrict scale, double k) {
  for (size_t i = 0; i < n; ++i) {
    const double l2 = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
    const double inv = l2 > 0 ? 1 / std::sqrt(l2) : 0.0;
    const double g = k * scale[i] * (1 - rest[i] * inv);
    dx[i] *= g, dy[i] *= g, dz[i] *= g;
  }
}

/// The same with damping c along the springs; (wx, wy, wz) are the velocity differences.
inline void run_damped_forces(size_t n, double* __restrict dx, double* __restrict dy, double* __restrict dz,
                              const double* __restrict wx, const double* __restrict wy,
                              const double* __restrict wz, const double* __restrict rest,
                              const double* __restrict scale, double k, double c) {
  for (size_t i = 0; i < n; ++i) {
    const double l2 = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
    const double inv = l2 > 0 ? 1 / std::sqrt(l2) : 0.0;
    const double wd = wx[i] * dx[i] + wy[i] * dy[i] + wz[i] * dz[i];
    const double g = k * scale[i] * (1 - rest[i] * inv) + c * wd * (inv * inv);
    dx[i] *= g, dy[i] *= g, dz[i] *= g;
  }
}

}  // namespace truestep::spring
