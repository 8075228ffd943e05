// How a system's points are connected, for drawing and streaming. Changes rarely; a system's
// `topology_version` does when it does.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace truestep {

enum class LineKind : uint8_t { structural = 0, shear = 1, bending = 2, other = 3 };

struct Topology {
  std::vector<std::array<uint32_t, 2>> lines;
  std::vector<LineKind> line_kinds;  ///< one per line, or empty
  std::vector<std::array<uint32_t, 3>> triangles;
  double point_radius = 0;                     ///< m; 0: points are not drawn as spheres
  std::optional<std::array<double, 3>> color;  ///< linear r g b in [0, 1]
};

}  // namespace truestep
