// Refinement of ropes, coils, hair, cloth and blocks. A chain of n links of stiffness k is as stiff as one of
// 2 n with 2 k; a sheet keeps the stiffness of its links at any number of them; a block of links of length L
// has the modulus k / L, so that half of L needs k / 2. Moduli, rigidities and mass by density belong to the
// object. Damping per point is divided among the points. At ends and borders the lumped values are off by
// half a link, which makes them first order there. What Gauss-Seidel iterations leave is not removed by
// refinement with their number given.
#include "engine/systems/xpbd/xpbd_resolution.h"

#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

namespace {

using Why = std::optional<std::string>;

constexpr double kMost = 1e6;  // along a line

Why cannot(const XpbdDef& d) {
  if (d.mesh) return "a mesh cannot be refined";
  if (!d.density)
    return "with a given mass per point the total mass depends on the resolution: give a density";
  if (d.scheme == Scheme::pbd) return "with scheme pbd the stiffness depends on the resolution: use xpbd";
  if (d.tear) return "tears follow the links, which differ between resolutions";
  if (!d.pins.empty()) return "pins by index mean other points at another resolution: give names (pinned)";
  if (!d.attachments.empty() || !d.loads.empty())
    return "attachments and loads by index mean other points at another resolution";
  return std::nullopt;
}

Why divide(void* def, double factor) {
  auto& d = *static_cast<XpbdDef*>(def);
  if (Why why = cannot(d)) return why;
  if (d.rope || d.helix || d.hair) {
    int& links = d.rope ? d.rope->links : d.helix ? d.helix->links : d.hair->links;
    if (!divided(links, factor, 2, kMost)) return "numbers of links must be whole and at least 2";
    d.stiffness *= factor, d.internal_damping *= factor, d.damping /= factor;
    return std::nullopt;
  }
  if (d.block) {
    SoftBlockShape& b = *d.block;
    for (int* cells : {&b.cells_x, &b.cells_y, &b.cells_z}) {
      if (!divided(*cells, factor, 1, kMost)) return "numbers of cells must be whole";
    }
    d.stiffness /= factor, d.internal_damping /= factor, d.damping /= factor * factor * factor;
    return std::nullopt;
  }
  // Points along a side; refinement divides the links between them.
  ClothGridShape& g = *d.cloth_grid;
  int u = g.nx - 1, v = g.ny - 1;
  if (!divided(u, factor, 2, kMost) || !divided(v, factor, 2, kMost))
    return "nx - 1 and ny - 1 must be whole numbers";
  g.nx = u + 1, g.ny = v + 1;
  d.damping /= factor * factor;
  return std::nullopt;
}

// Positions in a line, a sheet or a block, as shares of its lengths; strands and copies stand side by side.
std::vector<Vec3> places(const void* def) {
  const auto& d = *static_cast<const XpbdDef*>(def);
  int counts[] = {1, 1, 1};  // of points
  double steps[] = {1, 1, 1};
  const auto share = [&](int axis, int links) { counts[axis] = links + 1, steps[axis] = 1.0 / links; };
  if (d.rope || d.helix) share(0, d.rope ? d.rope->links : d.helix->links);
  if (d.hair) share(0, d.hair->links), counts[1] = d.hair->strands;
  if (d.cloth_grid) share(0, d.cloth_grid->nx - 1), share(1, d.cloth_grid->ny - 1);
  if (d.block) share(0, d.block->cells_x), share(1, d.block->cells_y), share(2, d.block->cells_z);
  const size_t copies = d.copies.empty() ? 1 : d.copies.size();
  std::vector<Vec3> out;
  for (size_t copy = 0; copy < copies; ++copy) {
    for (int k = 0; k < counts[2]; ++k) {
      for (int j = 0; j < counts[1]; ++j) {
        for (int i = 0; i < counts[0]; ++i)
          out.push_back({i * steps[0] + 2 * static_cast<double>(copy), j * steps[1], k * steps[2]});
      }
    }
  }
  return out;
}

}  // namespace

const Resolution& xpbd_resolution() {
  static const Resolution kCounts{
      .parameter =
          "rope.links, helix.links, hair.links, cloth_grid.nx and ny, block.cells_x, cells_y, cells_z",
      .divide = divide,
      .order = [](const void*) { return 0; },
      .places = places};
  return kCounts;
}

}  // namespace truestep::xpbd
