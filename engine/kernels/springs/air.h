// Air resistance from the velocity u of the air relative to a surface (density rho, drag coefficient C):
//   plate of area A, unit normal n:   f = 1/2 rho C A |u . n| (u . n) n        (pressure only, no friction)
//   cylinder of cross-section S:      f = 1/2 rho C S |u| u
// Hoerner, "Fluid-Dynamic Drag" (1965), chapter 3: C about 1.2 for plates and long cylinders across the flow.
// Both derivatives -df/du are symmetric and positive semidefinite.
#pragma once
#include <array>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::air {

/// Wind (m/s) of which the fraction `gust` varies periodically: a wave made of two parabolas, with a
/// continuous slope and the same bits on every platform.
inline Vec3 gusty(const Vec3& wind, double gust, double period, double t) {
  if (!(gust > 0)) return wind;
  const double p = t / period - std::floor(t / period);
  const double wave = p < 0.5 ? 16 * p * (0.5 - p) : -16 * (p - 0.5) * (1 - p);
  return wind * (1 + gust * wave);
}

/// Force (N) on a triangle whose doubled area vector is N = (p1 - p0) x (p2 - p0); q = rho C / 2.
inline Vec3 plate_force(const Vec3& area2, const Vec3& u, double q) {
  const double length = norm(area2);
  if (!(length > 0)) return {};
  const double un = dot(u, area2) / length;
  return (0.5 * q * std::abs(un) * un) * area2;
}

/// df/du of plate_force is s N N^T; returns s.
inline double plate_slope(const Vec3& area2, const Vec3& u, double q) {
  const double length2 = norm2(area2);
  if (!(length2 > 0)) return 0;
  const double length = std::sqrt(length2);
  return q * std::abs(dot(u, area2) / length) / length;
}

/// Dissipation function R (W): plate_force = dR/du.
inline double plate_dissipation(const Vec3& area2, const Vec3& u, double q) {
  const double length2 = norm2(area2);
  if (!(length2 > 0)) return 0;
  const double un = std::abs(dot(u, area2));
  return q * un * un * un / (6 * length2);
}

/// Force (N) on a piece of cylinder of cross-section `section` m^2.
inline Vec3 cylinder_force(const Vec3& u, double q, double section) {
  return (q * section * norm(u)) * u;
}

/// Dissipation function R (W): cylinder_force = dR/du.
inline double cylinder_dissipation(const Vec3& u, double q, double section) {
  return q * section * norm(u) * norm2(u) / 3;
}

/// df/du of cylinder_force = alpha I + beta u u^T; returns {alpha, beta}.
inline std::array<double, 2> cylinder_slope(const Vec3& u, double q, double section) {
  const double speed = norm(u);
  return {q * section * speed, speed > 0 ? q * section / speed : 0.0};
}

}  // namespace truestep::air
