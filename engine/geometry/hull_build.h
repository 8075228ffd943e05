// The step from quickhull's triangles to the faces of a Hull; internal to convex_hull().
#pragma once
#include <array>
#include <vector>

#include "engine/geometry/hull.h"

namespace truestep {

struct HullTriangle {
  std::array<uint32_t, 3> v;       ///< points, anticlockwise from outside
  std::array<uint32_t, 3> beyond;  ///< triangle across the edge v[k] -> v[k + 1]
};

/// Joins triangles that lie in one plane into faces, drops points in the middle of faces and edges.
Hull merge_triangles(std::span<const Vec3> points, const std::vector<HullTriangle>& triangles);

}  // namespace truestep
