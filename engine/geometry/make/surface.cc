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

namespace {

struct OwnEdge {
  int64_t low, high;
  size_t corner;
  auto operator<=>(const OwnEdge&) const = default;
};

/// Empty where an index is out of range, which has an error of its own.
std::vector<OwnEdge> edges_of(const MeshShape& shape) {
  const auto& corners = shape.triangles;
  const auto n = static_cast<int64_t>(shape.vertices.size());
  std::vector<OwnEdge> out;
  for (size_t k = 0; k + 2 < corners.size(); k += 3) {
    for (size_t i = 0; i < 3; ++i) {
      const int64_t a = corners[k + i], b = corners[k + (i + 1) % 3];
      if (a < 0 || b < 0 || a >= n || b >= n) return {};
      if (a != b) out.push_back({std::min(a, b), std::max(a, b), k + i});
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string named(const OwnEdge& e) {
  return "the edge of vertices " + std::to_string(e.low) + " and " + std::to_string(e.high);
}

}  // namespace

std::optional<ClothFault> flat_triangle(const MeshShape& shape) {
  const std::vector<OwnEdge> edges = edges_of(shape);
  if (edges.empty()) return std::nullopt;
  const auto& x = shape.vertices;
  for (const OwnEdge& e : edges) {
    if (norm2(x[static_cast<size_t>(e.high)] - x[static_cast<size_t>(e.low)]) > 0) continue;
    return ClothFault{e.corner, named(e) + " has no length: merge them"};
  }
  // Relative to the longest edge: what rounding leaves of three vertices in line.
  constexpr double kLeast = 1e-12;
  size_t corner = 0;
  for (const auto& t : mesh_triangles(shape)) {
    const Vec3 u = x[t[1]] - x[t[0]], v = x[t[2]] - x[t[0]];
    const double longest = std::max({norm2(u), norm2(v), norm2(v - u)});
    if (!(norm(cross(u, v)) > kLeast * longest)) {
      return ClothFault{corner, "the triangle of vertices " + std::to_string(t[0]) + ", " +
                                    std::to_string(t[1]) + " and " + std::to_string(t[2]) +
                                    " has no area, because they lie in line: remove it or move one"};
    }
    corner += 3;
  }
  return std::nullopt;
}

std::optional<ClothFault> crowded_edge(const MeshShape& shape) {
  const std::vector<OwnEdge> edges = edges_of(shape);
  for (size_t i = 2; i < edges.size(); ++i) {
    if (edges[i].low != edges[i - 2].low || edges[i].high != edges[i - 2].high) continue;
    return ClothFault{edges[i].corner, named(edges[i]) + " has more than two triangles"};
  }
  return std::nullopt;
}

}  // namespace truestep
