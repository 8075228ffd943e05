// Viscosity of central advection by implicit steps: Crank-Nicolson, or backward Euler after a jump.
#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::Mirror;

bool Flow::implicit(double viscosity, double h) const {
  const GridFluidDef& d = model_->def;
  if (viscosity == 0 || model_->two_viscosities()) return false;
  if (d.advection != GridFluidDef::Advection::central) return true;
  if (model_->sharp_walls()) return false;
  if (d.viscous != GridFluidDef::Viscous::automatic) return d.viscous == GridFluidDef::Viscous::implicit;
  double rate = 0;
  for (size_t a = 0; a < model_->grid.dimensions; ++a)
    rate += 4 / (model_->grid.spacing[a] * model_->grid.spacing[a]);
  // Stability with rotating eddies: half of the real axis that the method allows.
  const double held = d.stepping == GridFluidDef::Stepping::rk3 ? 1.25 : 0.5;
  return viscosity * rate * h > held;
}

// Transforms have mirror images beyond walls where the differences have parabolas, whose friction is larger:
// a solve by them divides modes of the wall by too little, by up to m = 4/3 (in corners 5/3), which long
// steps would amplify. With the difference on the right of two more solves, weighed by 1 and 1 / m, modes
// lack between 0 and 0.004 of their change (in corners 0.03): never less than 0, so that steps of any length
// are stable, and nothing where the walls are not felt.
void Flow::diffuse(size_t c, double amount, double* change) {
  const mac::MacGrid& g = model_->grid;
  const double walls = static_cast<double>(g.dimensions) - 1;  // that meet in a corner and are parallel to c
  double r = 0;
  bool any = false;
  for (size_t a = 0; a < g.dimensions; ++a) {
    r = std::max(r, amount / (g.spacing[a] * g.spacing[a]));
    for (size_t end = 0; end < 2 && a != c; ++end) any = any || sides_[c][a][end].mirror == Mirror::given;
  }
  // Up to here one solve is stable.
  if (!any || r <= 0.75 / walls) return viscous_[c]->solve(1, amount, change, *arena_);
  double *once = array(9), *twice = array(c);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    std::copy_n(change + at, n, once + at), std::copy_n(change + at, n, twice + at);
  });
  viscous_[c]->solve(1, amount, once, *arena_);
  mac::add_wall_curvature(g, c, sides_[c], once, amount, twice, *arena_);
  viscous_[c]->solve(1, amount, twice, *arena_);
  mac::add_wall_curvature(g, c, sides_[c], twice, amount, change, *arena_);
  viscous_[c]->solve(1, amount, change, *arena_);
  const double weight = 1 / (1 + walls / 3);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) change[i] = twice[i] + weight * (change[i] - twice[i]);
  });
}

// A wall that starts at once sets waves of every length in motion. Crank-Nicolson leaves those that a step
// does not resolve as they are but for their sign; backward Euler in the first step, divided into halves,
// damps them and keeps second order (Rannacher 1984, "Finite element solution of diffusion problems with
// irregular data"). Beside a smooth flow a wall's velocity differs from that of the line through two cells by
// the square of the spacing; a tenth of the fastest, as the mean over a wall, is far more than that, and more
// than the corner of a moving wall and one at rest adds.
bool Flow::walls_jump(const FlowFields& f, double t) {
  constexpr double kJump = 0.1;
  sides_at(t);
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < g.dimensions; ++c) {
    double fastest = mac::largest_of_rows(g, c, *arena_, [&](size_t at, size_t n) {
      double most = 0;
      for (size_t i = at; i < at + n; ++i) most = std::max(most, std::abs(f.u[c][i]));
      return most;
    });
    double furthest = 0;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2, s = g.stride(a);
      for (size_t end = 0; end < 2 && a != c; ++end) {
        const mac::SideValues& side = sides_[c][a][end];
        if (side.mirror != Mirror::given) continue;
        const size_t rows = g.count(c, first), planes = g.count(c, second);
        double sum = 0;
        for (size_t q = 0; q < planes; ++q) {
          for (size_t p = 0; p < rows; ++p) {
            const size_t depth = second < g.dimensions ? q : 0;
            const size_t line = g.base() + p * g.stride(first) + depth * g.stride(second);
            const size_t ghosts = second < g.dimensions ? mac::kGhosts : 0;
            const double wall = side.at(p + mac::kGhosts + g.padded(first) * (depth + ghosts));
            const double* u = f.u[c] + line + (end == 0 ? 0 : (g.cells[a] - 1) * s);
            const double next = end == 0 ? u[s] : *(u - s);
            sum += std::abs(wall - (1.5 * u[0] - 0.5 * next));
            fastest = std::max(fastest, std::abs(wall));
          }
        }
        furthest = std::max(furthest, sum / static_cast<double>(rows * planes));
      }
    }
    if (furthest > kJump * fastest) return true;
  }
  return false;
}

}  // namespace truestep::grid_fluid
