// Signed distance of a point to a solid in the solid's own frame, for any solid: used by contacts of many
// points. Does not allocate.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/geometry/solid.h"

namespace truestep {

struct PointDistance {
  double distance = 0;  ///< m, negative inside
  Vec3 normal;          ///< unit, outward
};

/// Whether a mesh is only the front of its triangles, or what these enclose is inside of it.
enum class MeshSides : uint8_t { front, enclosed };
/// front of a mesh with a border, else enclosed.
MeshSides mesh_sides(const Solid& solid);

/// Nothing beyond `within` (m), of an enclosed mesh on either side; of the front of a mesh and of a height
/// field the triangles that the point is in front of.
std::optional<PointDistance> point_distance(const Solid& solid, const Vec3& p, double within,
                                            MeshSides sides = MeshSides::front);

}  // namespace truestep
