// Contacts in space as they will be a little later. They are found once a step and stay as they are through
// its n substeps: found for the bodies' poses at its start, normals and arms lag by (n - 1) / 2 substeps on
// average, and so does the force of loads that follow bodies as they roll on one another, which feeds every
// rocking mode (docs/standing.md, "Rolling on rolling bodies"). A contact that bears is therefore found for
// the poses t = (n - 1) / (2 n) of the step later, as far as the bodies' velocities tell, and brought back:
// with J the motion of its points along the normal there, its separations are
//   s(now) = s(later) - t J (v, w),
// so that what the solver linearises is the contact half-way through the substeps.
#pragma once
#include "engine/collision/pairs/manifold.h"
#include "engine/geometry/transform.h"

namespace truestep {

/// Motion of a body about its centre of mass.
struct SpaceMotion {
  Vec3 velocity, spin;  ///< m/s, rad/s
};

/// The place of a body after a time t (s) of this motion, to the fourth order of the angle.
inline Transform place_after(const Transform& at, const SpaceMotion& m, double t) {
  const Vec3 turn = m.spin * t;
  const double square = norm2(turn);
  const double sine = 1 - square / 6, rest = 0.5 - square / 24;
  const auto turned = [&](const Vec3& axis) {
    const Vec3 once = cross(turn, axis);
    return axis + once * sine + cross(turn, once) * rest;
  };
  const Rotation& r = at.rotation;
  return {inverse(Rotation{{turned(axis(r, 0)), turned(axis(r, 1)), turned(axis(r, 2))}}),
          at.position + m.velocity * t};
}

/// m/s at which the surfaces of b and a part at a point x along n; the bodies are at a and b.
inline double parting_speed(const Vec3& x, const Vec3& n, const Transform& a, const SpaceMotion& of_a,
                            const Transform& b, const SpaceMotion& of_b) {
  const Vec3 va = of_a.velocity + cross(of_a.spin, x - a.position),
             vb = of_b.velocity + cross(of_b.spin, x - b.position);
  return dot(n, vb - va);
}

}  // namespace truestep
