// Obstacles in a flow on a grid: second-order walls, and obstacles moved by the scene.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

// A cylinder in a stream through a periodic box, and the same cylinder dragged through fluid at rest: drag is
// Galilean invariant.
double drag_in_periodic_box(int64_t cells, bool moves) {
  GridFluidDef d;
  d.cells = {cells, cells};
  d.size = {4, 4};
  d.viscosity = 0.05;
  d.tolerance = 1e-8;
  d.all = FlowSideDef{SideKind::periodic, {}};
  ObstacleDef o{.center = {moves ? 2.5 : 2.0, 2.03, 0}, .radius = 0.5};
  if (moves) {
    o.displacement = {"-t", "0"};
  } else {
    d.initial = {"1", "0"};
  }
  d.obstacles = {o};
  GridFlow run(d, 0.02);
  double sum = 0;
  run.steps(20);
  for (int k = 0; k < 25; ++k) run.steps(1), sum += run.observed("obstacle.drag");
  EXPECT_LT(run.observed("divergence.max"), 1e-5);  // the residual's tolerance times U over a cell
  return sum / 25;
}

TEST(GridFluidWalls, AMovingObstacleIsAMovingFrame) {
  const double still = drag_in_periodic_box(64, false), moved = drag_in_periodic_box(64, true);
  std::printf("  drag %.4f at rest, %.4f moving\n", still, moved);
  // 16 cells across: 1.5 % were seen, 6 % with 8 across (set after seeing both).
  EXPECT_NEAR(moved, still, 0.025 * still);
  const double coarse = drag_in_periodic_box(32, true) - drag_in_periodic_box(32, false);
  EXPECT_GT(std::abs(coarse), 2 * std::abs(moved - still)) << "control: the difference is that of the grid";
}

// A body shaken in a closed box displaces fluid and pushes none through the walls.
TEST(GridFluidWalls, ABodyShakenInAClosedBoxLeavesNoDivergence) {
  using A = GridFluidDef::Advection;
  for (const A advection : {A::central, A::maccormack}) {
    GridFluidDef d;
    d.cells = {48, 48};
    d.viscosity = 0.01, d.advection = advection, d.tolerance = 1e-9;
    ObstacleDef o{.center = {0.5, 0.5, 0}, .radius = 0.12};
    o.displacement = {"0.2*sin(2*t)", "0.1*sin(3*t)"};
    d.obstacles = {o};
    GridFlow run(d, 0.02);
    double most = 0, fastest = 0;
    for (int k = 0; k < 100; ++k) {
      run.steps(1);
      most = std::max(most, run.observed("divergence.max"));
      fastest = std::max(fastest, run.observed("speed.max"));
    }
    std::printf("  divergence %.1e 1/s, speed %.2f m/s\n", most, fastest);
    // 0.5 m/s over cells of 1/48 m are 24 1/s; the solve leaves 1e-9 of the mean square.
    EXPECT_LT(most, 1e-6);
    EXPECT_GT(fastest, 0.4);
    EXPECT_LT(fastest, 2);
  }
}

}  // namespace
}  // namespace truestep::test
