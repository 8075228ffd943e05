// A liquid on a grid stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/grid_fluid/grid_fluid.h"
#include "tests/support/runs/system_run.h"

namespace truestep::test {

struct LiquidRun : testing_rig::SystemRun<std::unique_ptr<const System>> {
  LiquidRun(const grid_fluid::GridFluidDef& d, double dt, int threads = 1,
            const Vec3& gravity = {0, -9.81, 0})
      : SystemRun(
            [&] { return grid_fluid::build_grid_fluid(&d, {.id = "water", .gravity = gravity, .dt = dt}); },
            dt, threads) {}
  void steps(uint64_t n) { step(n); }
  uint64_t& done() { return SystemRun::steps; }
  /// m and m/s, x y z of every particle.
  std::span<const double> places() const { return state.f64(0); }
  std::span<const double> velocities() const { return state.f64(1); }
};

inline grid_fluid::LiquidBodyDef box_of_liquid(const Vec3& low, const Vec3& high) {
  return {
      .shape = grid_fluid::ObstacleDef::Shape::box, .center = 0.5 * (low + high), .half = 0.5 * (high - low)};
}

/// Water in a box with slip walls.
inline grid_fluid::GridFluidDef water(grid_fluid::GridFluidDef::Advection advection,
                                      std::vector<int64_t> cells, double spacing) {
  grid_fluid::GridFluidDef d;
  d.cells = cells;
  for (const int64_t n : cells) d.size.push_back(spacing * static_cast<double>(n));
  d.all = grid_fluid::FlowSideDef{grid_fluid::SideKind::slip, {}};
  d.advection = advection, d.density = 1000;
  return d;
}

}  // namespace truestep::test
