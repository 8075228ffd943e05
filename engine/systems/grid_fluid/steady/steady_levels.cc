// The grids of a steady flow, from coarse to fine: the scene's conditions on each, and interpolation from one
// to the next.
#include <algorithm>

#include "engine/base/errors.h"
#include "engine/systems/grid_fluid/steady/steady_flow.h"

namespace truestep::grid_fluid {

void SteadyFlow::check(const FlowModel& m) {
  std::vector<Issue> issues;
  const auto refuse = [&](const std::string& pointer, const std::string& why) {
    issues.push_back({pointer, "bad_value", why, "", "", "", ""});
  };
  for (size_t c = 0; c < 2; ++c) {
    if (m.texts.force[c].time)
      refuse("/force/" + std::to_string(c), "a steady flow needs forces that do not depend on t");
  }
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const std::string at = side_pointer(m.def, a, end) + "/velocity";
      std::vector<double> along;
      for (size_t c = 0; c < 2; ++c) {
        if (m.texts.sides[a][end][c].time) refuse(at, "a steady flow needs sides that do not depend on t");
      }
      if (!m.fourth_order() || m.kinds[a][end] != SideKind::wall) continue;
      m.texts.sample_side(m.grid, a, end, 1 - a, 0, along);
      for (const double v : along) {
        if (v == along[0]) continue;
        refuse(at, "with fourth order a wall must have the same velocity all along the side");
        break;
      }
    }
  }
  if (!issues.empty()) throw Error("scene_invalid", issues[0].message, issues);
}

// The scene's sides on a grid; the imbalance of their inflows is spread over them.
void SteadyFlow::add_level(const mac::MacGrid& g) {
  const FlowModel& m = *model_;
  Level& l = levels_.emplace_back();
  l.grid = g;
  double net = 0, area = 0;
  for (size_t c = 0; c < 2; ++c) {
    const auto mirrors = m.mirrors(c);
    for (size_t a = 0; a < 2; ++a) {
      for (size_t end = 0; end < 2; ++end) {
        mac::SideValues& side = l.sides[c][a][end];
        side.mirror = mirrors[a][end];
        const bool through = m.kinds[a][end] == SideKind::inflow;
        if (side.mirror != mac::Mirror::given || (a == c && !through)) continue;
        m.texts.sample_side(g, a, end, c, 0, side.values);
        if (a != c) continue;
        for (size_t p = 0; p < g.cells[1 - a]; ++p) {
          net += (end == 0 ? -1 : 1) * side.values[p + mac::kGhosts] * g.spacing[1 - a];
          area += g.spacing[1 - a];
        }
      }
    }
    if (m.texts.force[c].zero) continue;
    l.force[c].assign(g.size(), 0);
    m.texts.sample(m.texts.force[c], g, c, 0, l.force[c].data());
  }
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      for (double& v : l.sides[a][a][end].values) v -= (end == 0 ? -1 : 1) * net / area;
    }
  }
  // psi along the sides from the corner (0, 0), both ways round.
  l.boundary.assign(g.size(), 0);
  const auto through = [&](size_t a, size_t end, size_t p) {
    const auto& values = l.sides[a][a][end].values;
    return values.empty() ? 0 : values[p + mac::kGhosts];
  };
  double* psi = l.boundary.data();
  const size_t nx = g.cells[0], ny = g.cells[1];
  for (size_t i = 0; i < nx; ++i)
    psi[g.at(i + 1, 0, 0)] = psi[g.at(i, 0, 0)] - through(1, 0, i) * g.spacing[0];
  for (size_t j = 0; j < ny; ++j) {
    psi[g.at(0, j + 1, 0)] = psi[g.at(0, j, 0)] + through(0, 0, j) * g.spacing[1];
    psi[g.at(nx, j + 1, 0)] = psi[g.at(nx, j, 0)] + through(0, 1, j) * g.spacing[1];
  }
  for (size_t i = 0; i + 1 < nx; ++i)
    psi[g.at(i + 1, ny, 0)] = psi[g.at(i, ny, 0)] - through(1, 1, i) * g.spacing[0];
}

// Cubic interpolation through four nodes, along x and then along y.
void SteadyFlow::prolong(const Level& coarse, const double* from, const Level& fine, double* to) const {
  const mac::MacGrid &c = coarse.grid, &f = fine.grid;
  const auto halfway = [](const double* p, ptrdiff_t s, size_t i, size_t n) {
    if (i == 0) return 0.0625 * (5 * p[0] + 15 * p[s] - 5 * p[2 * s] + p[3 * s]);
    if (i + 1 == n) return 0.0625 * (5 * p[s] + 15 * p[0] - 5 * p[-s] + p[-2 * s]);
    return 0.0625 * (9 * (p[0] + p[s]) - p[-s] - p[2 * s]);
  };
  for (size_t j = 0; j <= c.cells[1]; ++j) {
    for (size_t i = 0; i <= c.cells[0]; ++i) {
      const double* p = from + c.at(i, j, 0);
      double* q = to + f.at(2 * i, 2 * j, 0);
      q[0] = p[0];
      if (i < c.cells[0]) q[1] = halfway(p, 1, i, c.cells[0]);
    }
  }
  const auto s = static_cast<ptrdiff_t>(f.stride(1));
  for (size_t i = 0; i <= f.cells[0]; ++i) {
    for (size_t j = 0; j < c.cells[1]; ++j) {
      double* p = to + f.at(i, 2 * j, 0);
      p[s] = halfway(p, 2 * s, j, c.cells[1]);
    }
  }
}

}  // namespace truestep::grid_fluid
