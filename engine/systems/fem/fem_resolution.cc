// Refinement of finite elements: the same block or quad in more cells.
#include <cmath>

#include "engine/core/def/resolution.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

namespace {

bool divided(int& count, double factor) {
  constexpr int kMost = 2000;
  const double wanted = factor * count;
  if (wanted != std::floor(wanted) || wanted < 1 || wanted > kMost) return false;
  count = static_cast<int>(wanted);
  return true;
}

std::optional<std::string> divide(void* def, double factor) {
  auto& d = *static_cast<FemDef*>(def);
  if (d.mesh) return "a mesh of given cells cannot be refined";
  if (!d.pins.empty()) return "pins by index mean other nodes at another resolution: give names (pinned)";
  for (const SetDef& s : d.sets) {
    if (!s.points.empty()) return "point indices mean other nodes at another resolution: give the set a box";
  }
  if (d.fill) {
    d.fill->spacing /= factor;
    return std::nullopt;
  }
  const bool whole = d.block ? divided(d.block->cells_x, factor) && divided(d.block->cells_y, factor) &&
                                   divided(d.block->cells_z, factor)
                             : divided(d.quad->cells_x, factor) && divided(d.quad->cells_y, factor);
  if (!whole) return "numbers of cells must be whole";
  return std::nullopt;
}

}  // namespace

const Resolution& fem_resolution() {
  static const Resolution kCells{
      .parameter = "block.cells_x, cells_y, cells_z, quad.cells_x, cells_y, fill.spacing",
      .divide = divide,
      // Held corners and edges lower the order that an element has on smooth solutions.
      .order = [](const void*) { return 0; },
      .places = [](const void* def) { return build_mesh(*static_cast<const FemDef*>(def)).x; }};
  return kCells;
}

}  // namespace truestep::fem
