#include "engine/geometry/make/surface.h"

#include <algorithm>

namespace truestep {

std::vector<std::array<uint32_t, 3>> mesh_triangles(const MeshShape& shape) {
  std::vector<std::array<uint32_t, 3>> out;
  for (size_t t = 0; t + 2 < shape.triangles.size(); t += 3) {
    std::array<uint32_t, 3> corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = static_cast<uint32_t>(shape.triangles[t + k]);
    out.push_back(corners);
  }
  return out;
}

std::vector<double> mesh_shares(const MeshShape& shape) {
  const auto& x = shape.vertices;
  std::vector<double> out(x.size());
  for (const auto& t : mesh_triangles(shape)) {
    const double area = 0.5 * norm(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]));
    for (const uint32_t i : t) out[i] += area / 3;
  }
  return out;
}

std::vector<std::array<uint32_t, 3>> sorted_edges(const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<std::array<uint32_t, 3>> edges;
  for (const auto& t : triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t[(k + 2) % 3]});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace truestep
