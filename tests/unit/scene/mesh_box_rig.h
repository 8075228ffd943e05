// A box as a mesh of twelve triangles, for tests of contact with meshes.
#pragma once
#include <vector>

#include "engine/geometry/solid.h"

namespace truestep::testing_rig {

inline Solid mesh_of_box(const Vec3& half) {
  std::vector<Vec3> x;
  for (int k = 0; k < 8; ++k) {
    x.push_back({(k & 1 ? 1 : -1) * half.x, (k & 2 ? 1 : -1) * half.y, (k & 4 ? 1 : -1) * half.z});
  }
  return mesh_solid(x, {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5});
}

}  // namespace truestep::testing_rig
