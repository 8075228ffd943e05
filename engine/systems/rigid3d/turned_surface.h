// Cylinders that turn about their own axis: their surface stays in place while points of the rim pass.
#pragma once
#include "engine/geometry/compound.h"
#include "engine/systems/rigid3d/bodies.h"

namespace truestep::rigid3d {

/// The solid of a manifold's part, and its pose, if it is a solid of revolution that can be touched off its
/// axis; null for balls and capsules, whose contact normals always meet the axis.
inline const Solid* cylinder_of(const Solid& s, uint32_t part, Transform& at) {
  if (s.kind == SolidKind::cylinder) return &s;
  if (s.kind != SolidKind::compound) return nullptr;
  const Compound::Part& p = s.compound->parts()[part];
  if (p.solid.kind != SolidKind::cylinder) return nullptr;
  at = at * p.place;
  return &p.solid;
}

/// m/s along n at x: speed of a cylinder's material there due to rotation about its own axis.
inline double passes(const BodyKind& kind, uint32_t part, Transform at, const Vec3& spin, const Vec3& x,
                     const Vec3& n) {
  if (!cylinder_of(kind.solid, part, at)) return 0;
  const Vec3 own = axis(at.rotation, 1);
  return dot(own, spin) * dot(n, cross(own, x - at.position));
}

}  // namespace truestep::rigid3d
