// Obstacles in a flow on a grid: second-order walls, and obstacles moved by the scene.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/fluids/grid_flow.h"

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

// A channel driven by a force between two blocks that need not line up with the cells: the speed at its
// middle.
double speed_between_blocks(int64_t cells, double lower_wall) {
  constexpr double kWidth = 0.5;
  GridFluidDef d;
  d.cells = {4, cells};
  d.size = {4 / double(cells), 1};
  d.viscosity = 0.05;
  d.tolerance = 1e-10;
  d.force = {"1", "0"};
  d.sides.x_min = FlowSideDef{SideKind::periodic, {}};
  const ObstacleDef block{.shape = ObstacleDef::Shape::box, .center = {0, 0, 0}, .half = {1, 0.5, 1}};
  d.obstacles = {block, block};
  d.obstacles[0].center.y = lower_wall - 0.5, d.obstacles[1].center.y = lower_wall + kWidth + 0.5;
  GridFlow run(d, 0.05);
  run.steps(100);  // ten times what the slowest part takes to shrink by e
  return run.velocity(0, 0.5 * d.size[0], lower_wall + 0.5 * kWidth);
}

// Walls on faces, through the middles of cells and between. A wall that passes the middle of a cell turns it
// from fluid, which follows the equations, to solid, which follows the wall: the flow may change by the
// discretization's error, of second order, and elsewhere not at all.
TEST(GridFluidWalls, AChannelBetweenBlocksDoesNotFeelAHairsBreadth) {
  constexpr double kShift = 1e-7, kExact = 0.5 * 0.5 / (8 * 0.05);
  double jump[2] = {};
  for (const size_t finer : {0, 1}) {
    const int64_t cells = finer ? 64 : 32;
    for (const double share : {0.0, 0.25, 0.5, 0.75}) {
      const double wall = 0.25 + share / double(cells), here = speed_between_blocks(cells, wall);
      const double below = speed_between_blocks(cells, wall - kShift);
      const double above = speed_between_blocks(cells, wall + kShift);
      std::printf("  %.2f of %lld cells: %.3f %% off, shifts change %.1e, %.1e\n", share,
                  static_cast<long long>(cells), 100 * (here / kExact - 1), below / here - 1,
                  above / here - 1);
      EXPECT_NEAR(here, kExact, 2e-3 * kExact);  // 16 cells across: a quarter of (1/16)^2, twice
      const double most = std::max(std::abs(below - here), std::abs(above - here));
      if (share == 0.5) jump[finer] = most;
      // As much as the shift changes the width's square, ten times.
      EXPECT_LT(most, share == 0.5 ? 2e-3 * kExact : 10 * 4 * kShift * kExact) << share;
    }
  }
  EXPECT_LT(jump[1], 0.3 * jump[0]);
  // Control: a twentieth of a cell is felt.
  EXPECT_GT(std::abs(speed_between_blocks(32, 0.25 + 0.25 / 32) - speed_between_blocks(32, 0.25 + 0.3 / 32)),
            1e-6 * kExact);
}

}  // namespace
}  // namespace truestep::test
