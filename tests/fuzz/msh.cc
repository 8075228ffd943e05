// MSH files: whatever the bytes are, they give whole elements whose vertices are all used, with groups and a
// surface on the same vertices, or an error with its line.
#include "engine/geometry/read/msh.h"

#include "tests/fuzz/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const CellFile out = read_msh(text);
    check_vertices(out.vertices);
    if (out.cells.empty() || out.cells.size() % corners_of(out.form) != 0) __builtin_trap();
    std::vector<uint8_t> used(out.vertices.size());
    for (const uint32_t p : out.cells) used.at(p) = 1;
    if (std::count(used.begin(), used.end(), 0) > 0) __builtin_trap();
    for (const auto& g : out.groups) {
      if (g.name.empty() || !std::is_sorted(g.vertices.begin(), g.vertices.end())) __builtin_trap();
      if (!g.vertices.empty() && g.vertices.back() >= out.vertices.size()) __builtin_trap();
    }
    const SurfaceFile surface = surface_of(out);
    for (const auto& t : surface.triangles) {
      for (const uint32_t p : t) {
        if (p >= surface.vertices.size()) __builtin_trap();
      }
    }
  } catch (const MeshFault& fault) {
    check_fault(fault, text);
  }
  return 0;
}
