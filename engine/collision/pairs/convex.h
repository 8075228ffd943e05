// View of one convex solid for the narrow phase: a core (point, segment, box, cylinder, polyhedron, triangle)
// with a rounding radius around it, and its support function.
#pragma once
#include <cmath>

#include "engine/geometry/solid.h"
#include "engine/geometry/triangle_mesh.h"

namespace truestep {

struct Convex {
  SolidKind kind = SolidKind::sphere;
  Vec3 size;
  const Hull* hull = nullptr;
  const MeshTriangle* triangle = nullptr;

  /// Radius of spheres and capsules, zero for all others.
  double radius() const { return kind <= SolidKind::capsule ? size.x : 0; }
  /// A point inside the core.
  Vec3 center() const {
    if (kind == SolidKind::hull) return hull->center;
    if (kind == SolidKind::triangle) {
      return (triangle->corner[0] + triangle->corner[1] + triangle->corner[2]) / 3.0;
    }
    return {};
  }
  /// Approximate size, m.
  double extent() const {
    if (kind == SolidKind::hull) return hull->radius;
    if (kind == SolidKind::triangle) return norm(triangle->corner[1] - triangle->corner[0]);
    return norm(size);
  }
  /// Furthest point of the core along d (any length); ties go to the first.
  Vec3 support(const Vec3& d) const {
    switch (kind) {
      case SolidKind::capsule:
        return {0, d.y < 0 ? -size.y : size.y, 0};
      case SolidKind::box:
        return {d.x < 0 ? -size.x : size.x, d.y < 0 ? -size.y : size.y, d.z < 0 ? -size.z : size.z};
      case SolidKind::cylinder: {
        const double l = std::sqrt(d.x * d.x + d.z * d.z), s = l > 0 ? size.x / l : 0;
        return {d.x * s, d.y < 0 ? -size.y : size.y, d.z * s};
      }
      case SolidKind::hull: {
        const Vec3* v = hull->vertices.data();
        size_t best = 0;
        double most = dot(v[0], d);
        for (size_t i = 1; i < hull->vertices.size(); ++i) {
          const double s = dot(v[i], d);
          if (s > most) most = s, best = i;
        }
        return v[best];
      }
      case SolidKind::triangle: {
        const auto& c = triangle->corner;
        const double s0 = dot(c[0], d), s1 = dot(c[1], d), s2 = dot(c[2], d);
        return s0 >= s1 && s0 >= s2 ? c[0] : s1 >= s2 ? c[1] : c[2];
      }
      case SolidKind::sphere:
      case SolidKind::plane:
      case SolidKind::mesh:
      case SolidKind::height_field:
      case SolidKind::compound:
        break;
    }
    return {};
  }
};

/// The solid must be convex and outlive the view.
inline Convex view(const Solid& s) {
  return {s.kind, s.size, s.hull.get(), nullptr};
}
inline Convex view(const MeshTriangle& t) {
  return {SolidKind::triangle, {}, nullptr, &t};
}

}  // namespace truestep
