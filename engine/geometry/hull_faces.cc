// Faces of a hull from its triangles: a region grows from the largest triangle over all neighbours within
// 1e-9 of the extent of its plane; its border becomes the face's loop. A region whose border is not one
// simple loop stays triangulated, so the result is always a closed surface.
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "engine/geometry/hull_build.h"

namespace truestep {
namespace {

constexpr uint32_t kNoRegion = 0xffffffff;
constexpr double kFlat = 1e-9;

Vec3 area_vector(std::span<const Vec3> p, const HullTriangle& t) {
  return cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]);
}

/// Region of every triangle.
std::vector<uint32_t> regions(std::span<const Vec3> points, const std::vector<HullTriangle>& triangles,
                              double flat, uint32_t& count) {
  std::vector<double> area(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i) area[i] = norm(area_vector(points, triangles[i]));
  std::vector<uint32_t> order(triangles.size()), region(triangles.size(), kNoRegion), stack;
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return area[a] > area[b]; });
  count = 0;
  for (const uint32_t seed : order) {
    if (region[seed] != kNoRegion) continue;
    region[seed] = count;
    const Vec3 n = normalized(area_vector(points, triangles[seed]));
    const double offset = dot(n, points[triangles[seed].v[0]]);
    stack.assign(1, seed);
    while (!stack.empty()) {
      const HullTriangle& t = triangles[stack.back()];
      stack.pop_back();
      for (const uint32_t g : t.beyond) {
        if (region[g] != kNoRegion) continue;
        const auto& v = triangles[g].v;
        const bool level = std::all_of(
            v.begin(), v.end(), [&](uint32_t k) { return std::fabs(dot(n, points[k]) - offset) <= flat; });
        // A sliver's own normal is noise; its corners suffice.
        const bool sliver = area[g] <= 4 * flat * norm(points[v[1]] - points[v[0]]);
        if (!level || (!sliver && dot(n, area_vector(points, triangles[g])) <= 0)) continue;
        region[g] = count;
        stack.push_back(g);
      }
    }
    ++count;
  }
  return region;
}

/// Border of one region as a loop of points; empty when it is not one simple loop.
std::vector<uint32_t> border(const std::vector<std::array<uint32_t, 2>>& edges) {
  std::map<uint32_t, uint32_t> next;
  for (const auto& e : edges) {
    if (!next.emplace(e[0], e[1]).second) return {};
  }
  std::vector<uint32_t> loop;
  for (uint32_t v = edges[0][0]; loop.size() <= edges.size();) {
    loop.push_back(v);
    const auto it = next.find(v);
    if (it == next.end()) return {};
    v = it->second;
    if (v == edges[0][0]) break;
  }
  return loop.size() == edges.size() && loop.size() > 2 ? loop : std::vector<uint32_t>{};
}

}  // namespace

Hull merge_triangles(std::span<const Vec3> points, const std::vector<HullTriangle>& triangles) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  uint32_t count = 0;
  const double flat = kFlat * norm(high - low);
  const auto region = regions(points, triangles, flat, count);
  std::vector<std::vector<std::array<uint32_t, 2>>> edges(count);
  std::vector<std::vector<uint32_t>> members(count);
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    members[region[i]].push_back(i);
    for (size_t k = 0; k < 3; ++k) {
      if (region[triangles[i].beyond[k]] != region[i]) {
        edges[region[i]].push_back({triangles[i].v[k], triangles[i].v[(k + 1) % 3]});
      }
    }
  }
  std::vector<std::vector<uint32_t>> loops;
  for (uint32_t r = 0; r < count; ++r) {
    auto loop = edges[r].empty() ? std::vector<uint32_t>{} : border(edges[r]);
    if (!loop.empty()) {
      loops.push_back(std::move(loop));
      continue;
    }
    for (const uint32_t t : members[r]) loops.emplace_back(triangles[t].v.begin(), triangles[t].v.end());
  }

  // A point of only two faces is in the middle of an edge.
  std::vector<uint32_t> uses(points.size(), 0), place(points.size(), kNoRegion);
  for (const auto& loop : loops) {
    for (const uint32_t v : loop) ++uses[v];
  }
  Hull hull;
  for (const auto& loop : loops) {
    HullFace face;
    face.first = static_cast<uint32_t>(hull.loops.size());
    for (const uint32_t v : loop) {
      if (uses[v] < 3) continue;
      if (place[v] == kNoRegion) {
        place[v] = static_cast<uint32_t>(hull.vertices.size());
        hull.vertices.push_back(points[v]);
      }
      hull.loops.push_back(place[v]);
    }
    face.count = static_cast<uint32_t>(hull.loops.size()) - face.first;
    if (face.count > 2) {
      hull.faces.push_back(face);
    } else {
      hull.loops.resize(face.first);  // only a sliver along an edge
    }
  }
  complete_hull(hull);
  return hull;
}

void complete_hull(Hull& hull) {
  Vec3 sum;
  for (const Vec3& v : hull.vertices) sum += v, hull.radius = std::max(hull.radius, norm(v));
  hull.center = sum / static_cast<double>(hull.vertices.size());
  std::map<std::array<uint32_t, 2>, uint32_t> open;
  hull.edges.clear();
  hull.thickness = std::numeric_limits<double>::infinity();
  for (uint32_t f = 0; f < hull.faces.size(); ++f) {
    HullFace& face = hull.faces[f];
    const auto vertex = [&](uint32_t k) { return hull.loops[face.first + k % face.count]; };
    const Vec3 origin = hull.vertices[vertex(0)];
    Vec3 area;
    for (uint32_t k = 1; k + 1 < face.count; ++k) {
      area += cross(hull.vertices[vertex(k)] - origin, hull.vertices[vertex(k + 1)] - origin);
    }
    face.normal = normalized(area);
    face.offset = dot(face.normal, origin);
    for (uint32_t k = 0; k < face.count; ++k) {
      face.offset = std::max(face.offset, dot(face.normal, hull.vertices[vertex(k)]));
      const uint32_t from = vertex(k), to = vertex(k + 1);
      if (const auto it = open.find({to, from}); it != open.end()) {
        hull.edges[it->second].right = f;
      } else {
        open[{from, to}] = static_cast<uint32_t>(hull.edges.size());
        hull.edges.push_back({from, to, f, f});
      }
    }
    hull.thickness = std::min(hull.thickness, face.offset - dot(face.normal, hull.center));
  }
}

}  // namespace truestep
