// What is constant about a flow: its sides, and which faces are unknowns.
#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;
using mac::Mirror;

FlowModel::FlowModel(const GridFluidDef& d, const Vec3& g)
    : def(d), grid(make_grid(d)), texts(d, grid), gravity(g) {
  ObstaclePlaces start;
  texts.place_obstacles(d.obstacles, 0, start);
  solids = Solids(start.obstacles, grid);
  bool inflow = false;
  for (size_t a = 0; a < grid.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      kinds[a][end] = side_of(d, a, end).kind;
      open = open || kinds[a][end] == SideKind::outflow;
      inflow = inflow || kinds[a][end] == SideKind::inflow;
    }
  }
  // A liquid with a surface has room for more.
  if (!inflow || open || d.liquid()) return;
  // Inflow must leave through other such sides, up to the grid's discretization error.
  double net = 0, through = 0;
  std::vector<double> values;
  for (size_t a = 0; a < grid.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      if (kinds[a][end] != SideKind::inflow) continue;
      texts.sample_side(grid, a, end, a, 0, values);
      const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
      const size_t ghosts2 = second < grid.dimensions ? mac::kGhosts : 0;
      const double area = grid.cell_volume() / grid.spacing[a];
      for (size_t q = 0; q < grid.cells[second]; ++q) {
        for (size_t p = 0; p < grid.cells[first]; ++p) {
          const double v = values[p + mac::kGhosts + grid.padded(first) * (q + ghosts2)] * area;
          net += end == 0 ? v : -v, through += std::abs(v);
        }
      }
    }
  }
  constexpr double kLeft = 0.02;
  if (std::abs(net) > kLeft * through) {
    const std::string why =
        "more flows in than out: " + std::to_string(net) + " of " + std::to_string(through);
    throw Error("scene_invalid", why,
                {"/sides", "not_balanced", why, "", "an outflow on one of the sides", "", ""});
  }
}

std::array<std::array<Mirror, 2>, 3> FlowModel::mirrors(size_t place) const {
  std::array<std::array<Mirror, 2>, 3> out{};
  for (size_t a = 0; a < 3; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind k = kinds[a][end];
      Mirror& m = out[a][end];
      if (a < grid.dimensions && k == SideKind::periodic) {
        m = Mirror::periodic;
      } else if (place == kPressure) {
        m = k == SideKind::outflow ? Mirror::odd : Mirror::even;
      } else if (place == kCentre) {
        m = Mirror::even;
      } else if (place == a) {
        m = k == SideKind::outflow ? Mirror::even : Mirror::given;
      } else {
        m = k == SideKind::wall || k == SideKind::inflow ? Mirror::given : Mirror::even;
      }
    }
  }
  return out;
}

std::array<size_t, 2> FlowModel::unknown(size_t c, size_t a) const {
  if (a >= grid.dimensions) return {0, 1};
  if (c != a || grid.periodic[a]) return {0, grid.cells[a]};
  return {kinds[a][0] == SideKind::outflow ? size_t{0} : 1,
          grid.cells[a] + (kinds[a][1] == SideKind::outflow ? 1 : 0)};
}

}  // namespace truestep::grid_fluid
