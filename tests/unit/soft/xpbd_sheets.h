// Sheets for xpbd systems with self-collision, and an independent check: edges that pierce triangles.
#pragma once
#include <algorithm>

#include "engine/collision/broad/box_grid.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep::testing_rig {

/// Adds n x n points from `corner`, spacing between them, and two triangles a cell.
inline void add_sheet(MeshShape& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, int64_t n) {
  const auto first = static_cast<int64_t>(mesh.vertices.size());
  for (int64_t j = 0; j < n; ++j) {
    for (int64_t i = 0; i < n; ++i) {
      mesh.vertices.push_back(corner + u * static_cast<double>(i) + v * static_cast<double>(j));
      if (i + 1 == n || j + 1 == n) continue;
      const int64_t a = first + j * n + i, b = a + 1, c = a + n, d = c + 1;
      for (const int64_t p : {a, b, d, a, d, c}) mesh.triangles.push_back(p);
    }
  }
}

/// Number of edges, counted once per triangle of theirs, that pierce one of `triangles`; `meets`(k, l):
/// whether the pair counts.
template <class Meets>
size_t piercings_of(const XpbdRun& run, const std::vector<std::array<uint32_t, 3>>& triangles,
                    const Meets& meets) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    return dot(p - a, cross(b - a, c - a));
  };
  const auto box = [&](const auto& points) {
    Box b = Box::nothing();
    for (const uint32_t p : points) b.cover(run.position(p));
    return b;
  };
  std::vector<Box> boxes;
  for (const auto& t : triangles) boxes.push_back(box(t));
  BoxGrid grid;
  grid.build(boxes);
  size_t count = 0;
  // Both triangles of an edge count it.
  const auto pierce = [&](size_t own, uint32_t e, uint32_t f) {
    const Vec3 p = run.position(e), q = run.position(f);
    grid.overlapping(box(std::array{e, f}), [&](uint32_t k) {
      const auto& t = triangles[k];
      if (std::ranges::count(t, e) + std::ranges::count(t, f) > 0 || !meets(own, size_t{k})) return;
      const Vec3 a = run.position(t[0]), b = run.position(t[1]), c = run.position(t[2]);
      if (side(a, b, c, p) * side(a, b, c, q) >= 0) return;
      const double s0 = side(p, q, a, b), s1 = side(p, q, b, c), s2 = side(p, q, c, a);
      count += (s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0);
    });
  };
  for (size_t k = 0; k < triangles.size(); ++k) {
    const auto& t = triangles[k];
    pierce(k, t[0], t[1]), pierce(k, t[1], t[2]), pierce(k, t[2], t[0]);
  }
  return count;
}

inline size_t piercings(const XpbdRun& run) {
  return piercings_of(run, run.system->body().triangles, [](size_t, size_t) { return true; });
}

}  // namespace truestep::testing_rig
