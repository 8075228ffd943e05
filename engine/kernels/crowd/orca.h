// Optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011, "Reciprocal n-body collision
// avoidance", eqs. 3 to 6): the half-plane of velocities with which an agent does its share of keeping two
// discs apart for a time tau. The velocities that would collide are a cone cut off by the disc of radius
// r/tau about p/tau; u is the shortest way out of it from the present relative velocity, and ORCA = {v : (v -
// (v_A + u/2)) . n >= 0}.
#pragma once
#include <cmath>

#include "engine/kernels/crowd/half_planes.h"

namespace truestep::crowd {

/// Sine of the smallest angle by which the way out of a head-on collision leads aside.
inline constexpr double kAside = 0.05;

/// p: from A to B (m). dv = v_A - v_B. reach: sum of the radii. horizon: tau (s); dt: the time in which an
/// overlap is to be resolved (s). share: fraction of u taken by A, 1/2 among equals. fallback: unit vector,
/// A's way out when both coincide.
inline HalfPlane orca_plane(const Vec3& p, const Vec3& v_a, const Vec3& v_b, double reach, double horizon,
                            double dt, double share, const Vec3& fallback) {
  const Vec3 dv = v_a - v_b;
  const double p2 = norm2(p);
  Vec3 n, u;
  const auto leave_disc = [&](double time) {
    Vec3 w = dv - p / time;
    // Two who meet head-on would only slow down, for ever. A tangent slightly aside excludes the collisions
    // too.
    const double across = p.x * w.y - p.y * w.x, least = kAside * std::sqrt(p2 * norm2(w));
    if (std::abs(across) < least) w += Vec3{-p.y, p.x, 0} * (((across >= 0 ? least : -least) - across) / p2);
    const double size = norm(w);
    n = size > 0 ? w / size : p2 > 0 ? p / -std::sqrt(p2) : fallback;
    u = n * (reach / time - dot(dv - p / time, n));
  };
  const Vec3 w = dv - p / horizon;
  const double back = dot(w, p);
  if (p2 <= reach * reach) {
    leave_disc(dt);
  } else if (back < 0 && back * back > reach * reach * norm2(w)) {
    leave_disc(horizon);
  } else {
    // The legs touch the disc of radius `reach` about p; e runs along the leg on w's side, away from here.
    const double leg = std::sqrt(p2 - reach * reach), side = p.x * w.y - p.y * w.x >= 0 ? 1 : -1;
    const Vec3 e = Vec3{p.x * leg - side * p.y * reach, side * p.x * reach + p.y * leg, 0} / p2;
    n = Vec3{-e.y, e.x, 0} * side;
    u = e * dot(dv, e) - dv;
  }
  return {n, dot(n, v_a + u * share)};
}

/// Velocities that keep a disc of radius r off a wall whose nearest point lies `distance` away along -n (n
/// unit, from the wall to the disc) for `horizon`: the tangent to the colliding velocities at the one closest
/// to rest, which is always admissible (section on static obstacles). Inside a wall: out again within `out`
/// seconds.
inline HalfPlane wall_plane(const Vec3& n, double distance, double r, double horizon, double out) {
  const double gap = distance - r;
  return {n, -gap / (gap >= 0 ? horizon : out)};
}

}  // namespace truestep::crowd
