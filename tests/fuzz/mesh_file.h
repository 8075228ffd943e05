// Requirements on any reader of surface files: every index refers to a vertex and every coordinate is finite,
// or the error is at a place in the file, or at one that the file lacks.
#pragma once
#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

inline void check_vertices(const std::vector<truestep::Vec3>& vertices) {
  if (vertices.empty()) __builtin_trap();
  for (const truestep::Vec3& p : vertices) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) __builtin_trap();
  }
}

inline void check_fault(const truestep::MeshFault& fault, std::string_view bytes) {
  const auto lines = static_cast<size_t>(std::count(bytes.begin(), bytes.end(), '\n')) + 1;
  const size_t most = fault.unit == truestep::MeshFault::Unit::line ? lines + 1 : bytes.size() + 1;
  if (fault.at < 1 || fault.at > most) __builtin_trap();
}

template <class Read>
int check_surface_reader(Read read, const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const truestep::SurfaceFile out = read(bytes);
    check_vertices(out.vertices);
    for (const auto& t : out.triangles) {
      for (const uint32_t p : t) {
        if (p >= out.vertices.size()) __builtin_trap();
      }
    }
  } catch (const truestep::MeshFault& fault) {
    check_fault(fault, bytes);
  }
  return 0;
}
