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

/// rad/s of a cylinder about its own axis; 0 for other bodies.
inline double own_spin(const BodyKind& kind, const Rotation& at, const Vec3& spin) {
  return kind.solid.kind == SolidKind::cylinder ? dot(axis(at, 1), spin) : 0;
}

/// The part of a body's spin that changes the place of its surface: a ball looks the same however it has
/// turned, and a cylinder after turns about its own axis.
inline Vec3 seen_spin(const BodyKind& kind, const Rotation& at, const Vec3& spin) {
  if (kind.reach == kind.inner) return {};
  return spin - axis(at, 1) * own_spin(kind, at, spin);
}

/// m/s along n at x: speed of a cylinder's material there due to rotation about its own axis.
inline double passes(const BodyKind& kind, uint32_t part, Transform at, const Vec3& spin, const Vec3& x,
                     const Vec3& n) {
  if (!cylinder_of(kind.solid, part, at)) return 0;
  const Vec3 own = axis(at.rotation, 1);
  return dot(own, spin) * dot(n, cross(own, x - at.position));
}

}  // namespace truestep::rigid3d
