// The first hit of a ray on a solid.
#pragma once
#include <optional>

#include "engine/geometry/solid.h"

namespace truestep {

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< any length but zero; distances are multiples of it
};

struct RayHit {
  double t = 0;       ///< at origin + t direction
  Vec3 normal;        ///< unit, of the surface, against the ray
  uint32_t part = 0;  ///< triangle of a mesh or height field, part of a compound
};

/// First hit with 0 <= t <= most; empty otherwise. A ray that starts inside a solid with a volume hits at
/// once, with the normal against the ray. Triangles are hit from both sides.
std::optional<RayHit> ray_cast(const Solid& solid, const Transform& at, const Ray& ray, double most);

}  // namespace truestep
