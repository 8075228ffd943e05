#include "engine/geometry/make/enclosure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/geometry/make/weld.h"

namespace truestep {
namespace {

struct Edge {
  uint32_t from, to;
  size_t index;  ///< of its first vertex in the triangles
};

std::string named(const Edge& e) {
  return "the edge from vertex " + std::to_string(e.from) + " to " + std::to_string(e.to);
}

/// Every edge must have one in the opposite direction, and only one.
std::optional<EnclosureFault> edge_fault(std::span<const int64_t> triangles) {
  std::vector<Edge> edges;
  edges.reserve(triangles.size());
  for (size_t k = 0; k < triangles.size(); ++k) {
    const size_t next = k % 3 == 2 ? k - 2 : k + 1;
    edges.push_back({static_cast<uint32_t>(triangles[k]), static_cast<uint32_t>(triangles[next]), k});
  }
  const auto before = [](const Edge& a, const Edge& b) {
    return std::array{a.from, a.to} < std::array{b.from, b.to};
  };
  std::stable_sort(edges.begin(), edges.end(), before);
  for (size_t k = 1; k < edges.size(); ++k) {
    if (before(edges[k - 1], edges[k])) continue;
    return EnclosureFault{edges[k].index, named(edges[k]) +
                                              " belongs to two triangles that run along it in "
                                              "the same direction"};
  }
  for (const Edge& e : edges) {
    if (std::binary_search(edges.begin(), edges.end(), Edge{e.to, e.from, 0}, before)) continue;
    return EnclosureFault{e.index, named(e) + " has a triangle on one side only: the surface must be closed"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<EnclosureFault> enclosure_fault(std::span<const Vec3> vertices,
                                              std::span<const int64_t> triangles) {
  const size_t whole = triangles.size();
  if (whole == 0 || whole % 3 != 0) return EnclosureFault{whole, "the length must be a multiple of three"};
  double volume = 0;
  Vec3 middle;
  for (const Vec3& v : vertices) middle += v / static_cast<double>(vertices.size());
  for (size_t k = 0; k < whole; ++k) {
    if (triangles[k] < 0 || static_cast<size_t>(triangles[k]) >= vertices.size()) {
      return EnclosureFault{k, "there is no such vertex"};
    }
    if (k % 3 != 2) continue;
    const auto corner = [&](size_t c) {
      return vertices[static_cast<size_t>(triangles[k - 2 + c])] - middle;
    };
    const Vec3 a = corner(0), u = corner(1) - a, v = corner(2) - a, area = cross(u, v);
    // Rounding leaves up to some 1e-16 of the edges' squares.
    if (!(norm2(area) > 1e-28 * std::max(norm2(u), norm2(v)) * std::max(norm2(u), norm2(v)))) {
      return EnclosureFault{k - 2, "the triangle has no area"};
    }
    volume += dot(a, area);
  }
  if (auto fault = edge_fault(triangles)) {
    // Corners that are repeated at one place are one: only then is something missing.
    const std::vector<uint32_t> first = first_at_place(vertices);
    std::vector<int64_t> welded;
    for (const int64_t p : triangles) welded.push_back(first[static_cast<size_t>(p)]);
    if (edge_fault(welded)) return fault;
  }
  if (!(volume > 0)) {
    return EnclosureFault{whole, "the triangles run clockwise seen from outside: reverse each"};
  }
  return std::nullopt;
}

EnclosingMesh ground_block(size_t nx, size_t nz, double spacing, std::span<const double> heights,
                           double beyond, double below) {
  EnclosingMesh out;
  const double bottom = *std::min_element(heights.begin(), heights.end()) - below;
  // The grid with a ring around it, twice: the surface, then the bottom.
  const size_t mx = nx + 2, mz = nz + 2;
  const auto place = [&](size_t i, size_t n) {
    const double half = 0.5 * static_cast<double>(n - 1) * spacing;
    if (i == 0) return -half - beyond;
    return i == n + 1 ? half + beyond : static_cast<double>(i - 1) * spacing - half;
  };
  for (const bool top : {true, false}) {
    for (size_t j = 0; j < mz; ++j) {
      for (size_t i = 0; i < mx; ++i) {
        const size_t u = std::clamp<size_t>(i, 1, nx) - 1, v = std::clamp<size_t>(j, 1, nz) - 1;
        out.vertices.push_back({place(i, nx), top ? heights[v * nx + u] : bottom, place(j, nz)});
      }
    }
  }
  const auto at = [&](size_t i, size_t j, bool top) {
    return static_cast<uint32_t>((top ? 0 : mx * mz) + j * mx + i);
  };
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    for (const uint32_t v : {a, b, c}) out.triangles.push_back(v);
  };
  for (size_t j = 0; j + 1 < mz; ++j) {
    for (size_t i = 0; i + 1 < mx; ++i) {
      // Cut as a height field's cells are.
      add(at(i, j, true), at(i, j + 1, true), at(i + 1, j, true));
      add(at(i + 1, j, true), at(i, j + 1, true), at(i + 1, j + 1, true));
      add(at(i, j, false), at(i + 1, j, false), at(i, j + 1, false));
      add(at(i + 1, j, false), at(i + 1, j + 1, false), at(i, j + 1, false));
    }
  }
  const auto side = [&](size_t i, size_t j, size_t k, size_t l) {  // seen from outside, from left to right
    add(at(i, j, false), at(k, l, false), at(i, j, true));
    add(at(i, j, true), at(k, l, false), at(k, l, true));
  };
  for (size_t i = 0; i + 1 < mx; ++i) side(i, mz - 1, i + 1, mz - 1), side(i + 1, 0, i, 0);
  for (size_t j = 0; j + 1 < mz; ++j) side(0, j, 0, j + 1), side(mx - 1, j + 1, mx - 1, j);
  return out;
}

}  // namespace truestep
