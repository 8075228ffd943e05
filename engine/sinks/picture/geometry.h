// A DrawList as vertices: spheres and lines as four corners each (the vertex shader spreads them), surfaces
// as triangles with area-weighted normals. Four copies of a corner beat instancing in a software rasteriser,
// which starts a new batch per instance.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/view.h"

namespace truestep::picture {

using Bytes4 = std::array<uint8_t, 4>;  ///< sRGB and an opacity

struct SphereVertex {
  Vec3f centre;
  float radius;
  Bytes4 color;
};
struct MeshVertex {
  Vec3f position, normal;
  Bytes4 color;
};
struct LineVertex {
  Vec3f from, to;
  float radius;
  Bytes4 color;
};

/// Vertices in picture units, ready for upload; cleared and refilled for every picture.
struct Geometry {
  std::vector<SphereVertex> spheres;  ///< 4 per sphere
  std::vector<SphereVertex> sprites;  ///< 1 per small sphere, near ones first
  std::vector<LineVertex> lines;      ///< 4 per line
  std::vector<LineVertex> marks;      ///< 4 per line, drawn over everything
  std::vector<MeshVertex> mesh;       ///< opaque; indexed by `triangles`
  std::vector<uint32_t> triangles;
  std::vector<MeshVertex> glass;  ///< containers; 3 per triangle, far ones first
  Extent extent;
  std::optional<double> ground_height;  ///< m along the list's up

  /// Throws Error("invalid_draw_list") when an index or an array length does not fit its points.
  void build(const DrawList& list, const View& view);

  void add_sphere(const View& view, const Vec3f& centre, float radius, Bytes4 color);
  void add_line(const View& view, const Vec3f& a, const Vec3f& b, float radius, Bytes4 color);
};

Bytes4 bytes_of(const Color& color);

/// Whether values colour points, lines or triangles of `set`.
bool has_scalars(const DrawPoints& set);

/// Limits of the colour map of `set`: the given ones, otherwise the smallest and largest finite value (0, 1
/// if there is none), or for a balance as far to both sides of zero.
std::pair<float, float> scalar_range(const DrawPoints& set);

/// The set's colour at t in [0, 1] of its range.
Color color_at(const DrawPoints& set, float t, Paper paper);

/// Sorts triangles by the distance of their centroids from the eye.
void sort_far_to_near(std::vector<MeshVertex>& triangles, const View& view);

/// Appends `shape` (see shape_mesh.cc); planes need `extent`.
void add_shape(Geometry& geometry, const View& view, const DrawShape& shape);

}  // namespace truestep::picture
