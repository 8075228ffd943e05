// Refinement of ropes, hair and cloth. A chain of n springs of stiffness k is as stiff as one of 2 n with 2
// k; a sheet keeps its spring stiffness at any number of springs. Mass comes from a density. At ends and
// borders the lumped values are off by half a link, which makes them first order there.
#include "engine/core/def/resolution.h"
#include "engine/systems/mass_spring/mass_spring_def.h"

namespace truestep::mass_spring {

namespace {

using Why = std::optional<std::string>;

constexpr double kMost = 1e6;  // links along a line

Why divide(void* def, double factor) {
  auto& d = *static_cast<MassSpringDef*>(def);
  if (d.mesh || d.free) return "a mesh or a free network cannot be refined";
  if (!d.density)
    return "with a given mass per point the total mass depends on the resolution: give a density";
  if (d.bending_stiffness > 0) {
    return "the effect of springs that skip a point depends on the resolution: give bending_rigidity or "
           "flexural_rigidity";
  }
  if (!d.pins.empty()) return "pins by index mean other points at another resolution: give names (pinned)";
  if (d.rope || d.hair) {
    if (!divided(d.rope ? d.rope->links : d.hair->links, factor, 2, kMost))
      return "numbers of links must be whole";
    d.stiffness *= factor, d.internal_damping *= factor, d.damping /= factor;
    return std::nullopt;
  }
  // Points along a side; refinement divides the links between them.
  auto& g = *d.cloth_grid;
  int u = g.nx - 1, v = g.ny - 1;
  if (!divided(u, factor, 2, kMost) || !divided(v, factor, 2, kMost))
    return "nx - 1 and ny - 1 must be whole numbers";
  g.nx = u + 1, g.ny = v + 1;
  d.damping /= factor * factor;
  return std::nullopt;
}

// Positions of the points in a sheet or along strands, as shares of their length.
std::vector<Vec3> places(const void* def) {
  const auto& d = *static_cast<const MassSpringDef*>(def);
  const int across = d.cloth_grid ? d.cloth_grid->nx : (d.rope ? d.rope->links : d.hair->links) + 1;
  const int lines = d.cloth_grid ? d.cloth_grid->ny : d.rope ? 1 : d.hair->strands;
  const double step = d.cloth_grid ? 1.0 / (lines - 1) : 1;
  std::vector<Vec3> out;
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < across; ++i) out.push_back({i / (across - 1.0), line * step, 0});
  }
  return out;
}

}  // namespace

const Resolution& mass_spring_resolution() {
  static const Resolution kCounts{.parameter = "rope.links, hair.links, cloth_grid.nx and ny",
                                  .divide = divide,
                                  .order = [](const void*) { return 0; },
                                  .places = places};
  return kCounts;
}

}  // namespace truestep::mass_spring
