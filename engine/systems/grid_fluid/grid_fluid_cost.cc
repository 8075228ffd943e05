// Cost estimates of a flow, and its refinement.
#include <algorithm>
#include <cmath>

#include "engine/lattice/divide_cells.h"
#include "engine/math/trig.h"
#include "engine/systems/grid_fluid/grid_fluid_checks.h"
#include "engine/systems/grid_fluid/steady/steady_flow.h"

namespace truestep::grid_fluid {

namespace {
// Faces, cells and the levels of the pressure solver; particles in the state, and twice in the order of
// cells.
Cost liquid_cost(const GridFluidDef& d, double padded) {
  const auto dim = static_cast<double>(d.cells.size());
  const double n = static_cast<double>(largest_count(d, static_cast<size_t>(expected_particles(d)))),
               affine = d.advection == GridFluidDef::Advection::apic ? dim * dim : 0;
  Cost c;
  c.state_bytes = 8 * padded * 2 + 8 * n * (7 + affine + (dyed(d) ? 1 : 0) + (changes(d) ? 1 : 0)) + 4e3;
  // Rows of faces with their neighbours, as many as the liquid covers.
  const double cells = n / trig::pow(static_cast<double>(d.particles_per_axis), dim);
  const double viscous = d.viscosity > 0 ? 4 * padded + cells * (60 + 24 * dim) : 0;
  const double solver = (dim == 2 ? 4.0 / 3 : 8.0 / 7) * (8 * (dim + 4) + 1) + 8 * 5;
  c.workspace_bytes = padded * (8 * (5 * dim + 3) + 8 + dim + 2 + solver) + viscous +
                      n * (16 * (2 * dim + affine + 1) + 20) + 3e5;
  const bool moving = std::ranges::any_of(
      d.obstacles, [](const ObstacleDef& o) { return !o.displacement.empty() || !o.angle.empty(); });
  if (moving) c.workspace_bytes += padded * (17 * dim + 1);
  c.elements = n;
  c.seconds_per_step = 1e-4 + 1e-6 * padded + 6e-7 * n;
  return c;
}
}  // namespace

Cost grid_fluid_cost(const void* def) {
  const auto& d = *static_cast<const GridFluidDef*>(def);
  double padded = 1;
  for (const int64_t c : d.cells) padded *= static_cast<double>(c) + 2.0 * mac::kGhosts + 1;
  if (d.liquid()) return liquid_cost(d, padded);
  const double components = static_cast<double>(d.cells.size());
  const bool ab2 = d.stepping == GridFluidDef::Stepping::ab2;
  const double solids = d.obstacles.empty() ? 0 : components + 1;
  const bool moving = std::ranges::any_of(
      d.obstacles, [](const ObstacleDef& o) { return !o.displacement.empty() || !o.angle.empty(); });
  Cost c;
  c.state_bytes =
      8 * padded * (components + 1 + (ab2 ? components : 0) + (d.scalar ? 1 : 0) + (d.second_fluid ? 2 : 0)) +
      4e3;
  // Rates, right-hand sides and transforms; the scalar's fluxes; fractions and levels if there are
  // solids.
  c.workspace_bytes = 8 * padded * (3 * components + 4 + 4 * solids + (d.scalar ? 5 : 0)) + 3e5;
  // Densities of faces and what is carried along there, levels of the pressure's solver and its five vectors.
  if (d.second_fluid) {
    c.workspace_bytes += 8 * padded * (3 * components + (components + 4) * 1.34 + 5) + padded * components;
    if (d.second_fluid->viscosity) c.workspace_bytes += 8 * padded;
  }
  // Fractions of faces a second time.
  if (moving) c.workspace_bytes += padded * (17 * components + 1);
  c.elements = cell_count(d);
  if (d.steady() && components == 2) {
    c.state_bytes = 8 * padded * 4 + 4e3;
    c.workspace_bytes = SteadyFlow::bytes(d) + 8 * padded * 18 + 3e5;
    c.seconds_per_step = 1e-5 + 1e-9 * padded;
    return c;
  }
  // Measured on one core: transforms and differences of a substep.
  c.seconds_per_step = 1e-5 + 1.5e-7 * padded;
  return c;
}

const Resolution& grid_fluid_resolution() {
  static const Resolution kCells{
      .parameter = "cells",
      .divide = [](void* def,
                   double factor) { return divide_cells(static_cast<GridFluidDef*>(def)->cells, factor, 4); },
      .order =
          [](const void* def) {
            const auto& d = *static_cast<const GridFluidDef*>(def);
            if (d.order == GridFluidDef::Order::fourth) return 4;
            return d.advection == GridFluidDef::Advection::semi_lagrangian ? 1 : 2;
          }};
  return kCells;
}

}  // namespace truestep::grid_fluid
