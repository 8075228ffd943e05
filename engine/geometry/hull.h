// Convex polyhedron: vertices, flat faces as loops, edges with the faces on both sides. Built from points
// with exact arithmetic (hull.cc), or filled in directly where the loops are known (boxes, triangles).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct HullFace {
  Vec3 normal;         ///< unit, outward
  double offset = 0;   ///< m; the face lies in normal . x = offset
  uint32_t first = 0;  ///< its loop is loops[first ... first + count), anticlockwise from outside
  uint32_t count = 0;
};

struct HullEdge {
  uint32_t from = 0, to = 0;     ///< vertices
  uint32_t left = 0, right = 0;  ///< faces; the left one's loop runs from -> to
};

struct Hull {
  std::vector<Vec3> vertices;
  std::vector<HullFace> faces;
  std::vector<uint32_t> loops;
  std::vector<HullEdge> edges;
  Vec3 center;           ///< a point well inside: the mean of the vertices
  double radius = 0;     ///< m, of the enclosing ball about the origin
  double thickness = 0;  ///< m, of the inscribed ball about the centre
};

/// Smallest convex hull of the points, flat faces merged where their corners lie within 1e-9 of the hull's
/// extent of one plane. Deterministic; points closer than 1e-12 of the extent are one. Error "bad_hull" when
/// there are fewer than four points, any is not finite or all lie (to 1e-9 of the extent) in a plane.
Hull convex_hull(std::span<const Vec3> points);

/// Completes faces' planes, edges, centre and radius of a hull whose vertices and loops are given.
void complete_hull(Hull& hull);

}  // namespace truestep
