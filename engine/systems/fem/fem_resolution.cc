// Refinement of finite elements: the same block or quad in more cells.
#include "engine/core/def/resolution.h"
#include "engine/systems/fem/fem_choice.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

namespace {

constexpr double kMost = 2000;  // cells along an edge

std::optional<std::string> divide(void* def, double factor) {
  auto& d = *static_cast<FemDef*>(def);
  if (d.mesh) return "a mesh of given cells cannot be refined";
  if (!d.pins.empty()) return "pins by index mean other nodes at another resolution: give names (pinned)";
  for (const SetDef& s : d.sets) {
    if (!s.points.empty()) return "point indices mean other nodes at another resolution: give the set a box";
  }
  settle_choices(d);
  if (d.fill) {
    d.fill->spacing /= factor;
    return std::nullopt;
  }
  const auto cells = [factor](int& count) { return divided(count, factor, 1, kMost); };
  const bool whole = d.block ? cells(d.block->cells_x) && cells(d.block->cells_y) && cells(d.block->cells_z)
                             : cells(d.quad->cells_x) && cells(d.quad->cells_y);
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
