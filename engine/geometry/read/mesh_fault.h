// What readers of mesh files share: the contents of a surface file, limits, and faults.
#pragma once
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// A file that is not a mesh: the line of a text or the byte of a binary file, counted from 1; one past the
/// end when something is missing.
class MeshFault : public std::runtime_error {
 public:
  enum class Unit : uint8_t { line, byte };
  MeshFault(Unit in, size_t where, const std::string& message)
      : std::runtime_error((in == Unit::line ? "line " : "byte ") + std::to_string(where) + ": " + message),
        unit(in),
        at(where) {}
  Unit unit;
  size_t at;
};

/// Vertices in the file's order and unit; triangles are oriented like the file's faces. Every index is valid,
/// every coordinate finite; triangles may be degenerate, and vertices may be unused.
struct SurfaceFile {
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Limits of a file's contents, checked before anything is allocated.
inline constexpr size_t kMostFileVertices = 2'000'000, kMostFileTriangles = 4'000'000;
/// A larger coordinate is considered a mistake.
inline constexpr double kMostFileCoordinate = 1e12;

}  // namespace truestep
