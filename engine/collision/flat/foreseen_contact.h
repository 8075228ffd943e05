// Where a contact lies a little later. Contacts are found once a step and stay as they are through its n
// substeps: normals and arms lag behind the bodies by (n - 1) / 2 of them on average, and so does the
// force of loads that follow bodies as they roll on one another. With a frequency w of such a mode the map of
// a step dt has the determinant 1 + (w dt)^2 (n - 1) / (2 n): the mode grows by w^2 dt (n - 1) / (4 n) a
// second, for nothing damps rolling. With the contact as it will be (n - 1) / (2 n) of the step later, as far
// as the bodies' velocities tell, the determinant is 1 (the step is symplectic, as with contacts found in
// every substep).
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/collision/flat/contact.h"
#include "engine/math/trig.h"

namespace truestep::flat {

/// rad by which the normal turns at most: what goes past a small corner is not followed round it.
inline constexpr double kMostForeseenTurn = 0.1;

/// Motion of a body about its centre of mass.
struct PlaneMotion {
  Vec2 velocity;    ///< m/s
  double spin = 0;  ///< rad/s
};

/// Turns the normal and moves the points (about the centre of a, as is `apart`, the centre of b) to where
/// they are `ahead` (s) later if both bodies go on; separations stay. `radius_a` and `radius_b` (m) are the
/// outlines' rounding. Returns how far it went (s): no farther than the normal may turn.
inline double foresee(Contact& c, Vec2& apart, const PlaneMotion& a, const PlaneMotion& b, double radius_a,
                      double radius_b, double ahead) {
  const Vec2 n = c.normal, relative = b.velocity - a.velocity;
  const auto velocity = [&](Side side, Vec2 at) {
    return side == Side::a ? a.spin * left_of(at) : relative + b.spin * left_of(at - apart);
  };
  double turn = c.face == Face::of_a ? a.spin : b.spin;
  if (c.face == Face::none) {
    const ContactPoint& p = c.point[0];
    const double length = radius_a + radius_b + p.separation;
    if (!(length > 0)) return 0;
    const Vec2 on_a = p.at - (radius_a + 0.5 * p.separation) * n;
    turn = cross(n, velocity(Side::b, on_a + length * n) - velocity(Side::a, on_a)) / length;
  }
  turn *= ahead;
  if (std::abs(turn) > kMostForeseenTurn) {
    const double share = kMostForeseenTurn / std::abs(turn);
    turn *= share, ahead *= share;
  }
  c.normal = unit(n + turn * left_of(n), n);
  for (uint32_t i = 0; i < c.points; ++i) {
    // The corner that the point belongs to moves with its body, and the rounding about it turns with the
    // normal.
    ContactPoint& p = c.point[i];
    const double half = 0.5 * p.separation,
                 radius = p.corner_of == Side::a ? -radius_a - half : radius_b + half;
    const Vec2 corner = p.at + radius * n;
    p.at = corner + ahead * velocity(p.corner_of, corner) - radius * c.normal;
  }
  apart = apart + ahead * relative;
  return ahead;
}

/// The same seen from a frame that turns at `frame` (rad/s) about the centre of a, exactly: what turns with
/// it has not moved there.
inline double foresee_turning(Contact& c, Vec2& apart, PlaneMotion a, PlaneMotion b, double radius_a,
                              double radius_b, double ahead, double frame) {
  b.velocity = b.velocity - frame * left_of(apart);
  a.spin -= frame, b.spin -= frame;
  ahead = foresee(c, apart, a, b, radius_a, radius_b, ahead);
  const trig::SinCos turn = trig::sincos(frame * ahead);
  const Rotation turned{turn.cos, turn.sin};
  c.normal = turned * c.normal, apart = turned * apart;
  for (uint32_t i = 0; i < c.points; ++i) c.point[i].at = turned * c.point[i].at;
  return ahead;
}

}  // namespace truestep::flat
