// Triangle meshes of cloth: as given by a scene, edges with the corners opposite them, areas of the points.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct MeshShape {
  std::vector<Vec3> vertices{};      // m
  std::vector<int64_t> triangles{};  // three indices each
};

std::vector<std::array<uint32_t, 3>> mesh_triangles(const MeshShape& shape);
/// m^2 per point: a third of every triangle's area for each of its corners.
std::vector<double> mesh_shares(const MeshShape& shape);

/// An edge of one triangle: (smaller end, larger end, opposite corner). Sorted, so that the triangles of an
/// edge are neighbours.
std::vector<std::array<uint32_t, 3>> sorted_edges(const std::vector<std::array<uint32_t, 3>>& triangles);

struct ClothFault {
  size_t corner;  ///< index into MeshShape::triangles
  std::string what;
};
/// The first edge without length or triangle without area. Nothing where indices are out of range.
std::optional<ClothFault> flat_triangle(const MeshShape& shape);
/// The first edge of more than two triangles, where bending is undefined.
std::optional<ClothFault> crowded_edge(const MeshShape& shape);

}  // namespace truestep
