// Surfaces of triangles that enclose a volume: what is wrong with one that does not, and the ground under a
// grid of heights.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct EnclosureFault {
  size_t index = 0;  ///< into the triangles' indices; the triangles' length: of the surface as a whole
  std::string what;
};

/// What keeps these triangles (triples of indices, anticlockwise seen from outside) from enclosing a volume:
/// indices that are not triples or have no vertex, a triangle without area, an edge that is not shared by two
/// triangles running along it in opposite directions, triangles that all face inwards. Whether the surface
/// cuts itself is not examined.
std::optional<EnclosureFault> enclosure_fault(std::span<const Vec3> vertices,
                                              std::span<const int64_t> triangles);

struct EnclosingMesh {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;
};
/// The ground under heights (m) at (i, j) of an nx x nz grid in the x-z plane, centred on the origin
/// (height_field.h): it goes on beyond the grid's border, as high as there, for `beyond` m, and ends `below`
/// m under the lowest height.
EnclosingMesh ground_block(size_t nx, size_t nz, double spacing, std::span<const double> heights,
                           double beyond, double below);

}  // namespace truestep
