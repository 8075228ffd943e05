// Pools that nothing connects but the box around them: one must not notice what happens in the other. What
// undoing compression lifted all liquid by was once taken from the motion of all of it, relative to its
// common mean velocity, so that a still pool was pushed to and fro by one that sloshed beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

constexpr double kCell = 1.0 / 32, kDepth = 8 * kCell;

/// Two basins on both sides of a wall of solid cells: a pool in the left one, a column that collapses in the
/// right one.
GridFluidDef two_basins(A advection, bool space) {
  std::vector<int64_t> cells{48, 32};
  if (space) cells.push_back(4);
  GridFluidDef d = water(advection, cells, kCell);
  d.obstacles = {{.shape = ObstacleDef::Shape::box, .center = {17 * kCell, 0.5, 0}, .half = {kCell, 0.6, 9}}};
  d.bodies = {box_of_liquid({0, 0, -1}, {16 * kCell, kDepth, 1}),
              box_of_liquid({18 * kCell, 0, -1}, {26 * kCell, 0.75, 1})};
  // Of the pressure: the solve ends when the whole box is good enough.
  d.tolerance = 1e-10;
  return d;
}

struct Moved {
  double fastest = 0, lift = 0;  ///< m/s, of the left pool; J, sum over the steps that lifted
};
Moved run_for(A advection, bool space, uint64_t steps) {
  LiquidRun run(two_basins(advection, space), 1.0 / 60);
  Moved out;
  for (uint64_t k = 0; k < steps; ++k) {
    const double before = run.observed("density.lift");
    run.steps(1);
    out.lift += std::max(0.0, run.observed("density.lift") - before);
    const auto x = run.places(), v = run.velocities();
    for (size_t p = 0; p < x.size(); p += 3) {
      if (x[p] < 17 * kCell) out.fastest = std::max(out.fastest, std::hypot(v[p], v[p + 1], v[p + 2]));
    }
  }
  return out;
}

TEST(LiquidPools, AStillPoolBesideASloshingOneStaysStill) {
  for (const A advection : {A::flip, A::apic}) {
    for (const bool space : {false, true}) {
      const Moved out = run_for(advection, space, 120);
      std::printf("  %s%s: still pool %.2e m/s; lifted %.1f J\n", advection == A::flip ? "flip" : "apic",
                  space ? " in space" : "", out.fastest, out.lift);
      // What undoing compression still leaves, to a hundredth of what it finds in the whole box, reached
      // 1.6e-4 m/s; while all liquid paid together it was 1.1e-2 to 1.9e-2.
      EXPECT_LT(out.fastest, 1e-3);
      EXPECT_GT(out.lift, 0.1) << "control: there was something to pay for";
    }
  }
}

}  // namespace
}  // namespace truestep::test
