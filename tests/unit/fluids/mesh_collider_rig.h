// Colliders of triangles, for tests of liquids against them.
#pragma once
#include "engine/collision/points/collider_def.h"

namespace truestep::testing_rig {

/// A box as twelve triangles.
inline MeshColliderDef box_of_triangles(const Vec3& center, const Vec3& half) {
  MeshColliderDef c;
  c.center = center;
  for (int k = 0; k < 8; ++k) {
    c.vertices.push_back({(k & 1 ? 1 : -1) * half.x, (k & 2 ? 1 : -1) * half.y, (k & 4 ? 1 : -1) * half.z});
  }
  c.triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return c;
}

inline BoxColliderDef box_collider(const Vec3& center, const Vec3& half) {
  BoxColliderDef c;
  c.center = center, c.half_extents = half;
  return c;
}

}  // namespace truestep::testing_rig
