// What readers of mesh files share: what a surface file holds, limits, and what is wrong where.
#pragma once
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// Where a file is no mesh: a line of a text, a byte of what is binary, each from 1. One past the end where
/// something is missing.
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

/// Vertices in the file's order and unit; triangles run as the file's faces do. Every index is one of a
/// vertex, every coordinate finite; triangles may be flat, repeat a corner or leave vertices over.
struct SurfaceFile {
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Most that a file may hold; kept in mind before anything is allocated.
inline constexpr size_t kMostFileVertices = 2'000'000, kMostFileTriangles = 4'000'000;
/// A coordinate beyond this is taken for a mistake.
inline constexpr double kMostFileCoordinate = 1e12;

}  // namespace truestep
