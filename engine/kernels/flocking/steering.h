// Turning and acceleration of steering agents, as pure functions: unit headings, angles in rad. Rotations are
// made from sines and cosines that the caller already has, never by inverse functions.
#pragma once
#include <array>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::flocking {

/// A unit vector perpendicular to the unit vector a; within the plane z = 0 if a is.
inline Vec3 perpendicular(const Vec3& a) {
  return a.x * a.x + a.y * a.y > 0.25 ? normalized(Vec3{-a.y, a.x, 0}) : normalized(Vec3{0, -a.z, a.y});
}

/// Unit heading `to`, or the heading `limit` away from the unit heading `from` on the way there.
inline Vec3 turn_towards(const Vec3& from, const Vec3& to, const trig::SinCos& limit) {
  const double along = dot(from, to);
  if (along >= limit.cos) return to;
  const Vec3 across = normalized(to - from * along, perpendicular(from));
  return from * limit.cos + across * limit.sin;
}

/// Unit heading turned by a random angle: in the plane uniform in +-spread / 2 (Vicsek et al. 1995, eq. 2),
/// in space uniform in solid angle over the cone of half angle spread / 2. u: uniform in [0, 1).
inline Vec3 disturbed(const Vec3& heading, double spread, bool plane, const std::array<double, 4>& u) {
  constexpr double kTurn = 6.283185307179586;
  if (plane) {
    const trig::SinCos a = trig::sincos(spread * (u[0] - 0.5));
    return {heading.x * a.cos - heading.y * a.sin, heading.x * a.sin + heading.y * a.cos, 0};
  }
  const double c = 1 - u[0] * (1 - trig::cos(0.5 * spread)), s = std::sqrt(std::fmax(0.0, 1 - c * c));
  const trig::SinCos around = trig::sincos(kTurn * u[1]);
  const Vec3 a = perpendicular(heading), b = cross(heading, a);
  return normalized(heading * c + a * (s * around.cos) + b * (s * around.sin), heading);
}

/// Push that keeps neighbours apart: 1 where they meet, falling to 0 at the radius; d from the neighbour to
/// here.
inline Vec3 separation(const Vec3& d, double r, double radius) {
  return r > 0 && r < radius ? d * ((1 - r / radius) / r) : Vec3{};
}

/// Influence (1 + r^2 / range^2)^-beta of Cucker and Smale (2007, eq. 2).
inline double influence(double r2, double range, double beta) {
  return beta == 0 ? 1 : trig::pow(1 + r2 / (range * range), -beta);
}

}  // namespace truestep::flocking
