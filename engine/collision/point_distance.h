// Signed distance of a point to any solid, in the solid's own frame: used by contacts of many points. Does
// not allocate.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/geometry/solid.h"

namespace truestep {

struct PointDistance {
  double distance = 0;  ///< m, negative inside
  Vec3 normal;          ///< unit, outward
};

/// Whether a mesh consists only of the front sides of its triangles, or also has the enclosed volume as its
/// inside.
enum class MeshSides : uint8_t { front, enclosed };
/// `front` for a mesh with a border, otherwise `enclosed`.
MeshSides mesh_sides(const Solid& solid);

/// Empty beyond `within` (m), which holds on both sides of an enclosed mesh. The front of a mesh and a height
/// field only count the triangles that the point is in front of.
std::optional<PointDistance> point_distance(const Solid& solid, const Vec3& p, double within,
                                            MeshSides sides = MeshSides::front);

}  // namespace truestep
