// How a system's points are connected and which solid shapes it brings, for drawing and streaming. Changes
// rarely; `version` grows when it does.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

enum class LineKind : uint8_t { structural = 0, shear = 1, bending = 2, other = 3 };

/// A solid to draw. Sizes in m; orientation is a unit quaternion (w, x, y, z).
struct DrawnShape {
  enum class Kind : uint8_t { plane, box, sphere, capsule } kind = Kind::sphere;
  Vec3 position;
  std::array<double, 4> orientation{1, 0, 0, 0};
  Vec3 size;  ///< plane: unit normal; box: half extents; sphere: (r, -, -); capsule: (r, half length of its y
              ///< axis, -)
  std::string id;
  bool container = false;  ///< points stay inside instead of outside
};

struct Topology {
  std::vector<std::array<uint32_t, 2>> lines;
  std::vector<LineKind> line_kinds;  ///< one per line, or empty
  std::vector<std::array<uint32_t, 3>> triangles;
  double point_radius = 0;                     ///< m; 0: points are not drawn as spheres
  std::optional<std::array<double, 3>> color;  ///< linear r g b in [0, 1]
};

}  // namespace truestep
