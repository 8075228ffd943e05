// The mass of a flow on a grid is its density times the volume between its obstacles, and of two fluids the
// sum of theirs.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

GridFluidDef fluid_box(std::vector<int64_t> cells) {
  GridFluidDef d;
  d.cells = std::move(cells), d.density = 800, d.origin = Vec3{-0.3, 0.2, 0.1};
  d.size = {2, 1};
  if (d.cells.size() == 3) d.size.push_back(1.5);
  return d;
}

double mass_of(const GridFluidDef& d) {
  return GridFlow(d, 0.01).observed("mass");
}

TEST(GridFluidMass, IsThatOfWhatObstaclesLeave) {
  EXPECT_NEAR(mass_of(fluid_box({37, 23})), 1600, 1e-9);
  EXPECT_NEAR(mass_of(fluid_box({21, 10, 13})), 2400, 1e-9);

  // Boxes along the grid that end anywhere within a cell: exact but for their corners, a thousandth of a cell
  // each.
  GridFluidDef d = fluid_box({40, 20});
  d.obstacles = {
      ObstacleDef{.shape = ObstacleDef::Shape::box, .center = {0.613, 0.641, 0}, .half = {0.217, 0.1834, 1}}};
  const double cell = 0.05 * 0.05, hole = 4 * 0.217 * 0.1834;
  EXPECT_NEAR(mass_of(d), 800 * (2 - hole), 800 * 4e-3 * cell);
  EXPECT_GT(800 * 0.1 * cell, 800 * 4e-3 * cell) << "control: a tenth of a cell would show";
  // Half outside the box that holds the fluid.
  d.obstacles[0].center.x = -0.3;
  EXPECT_NEAR(mass_of(d), 800 * (2 - hole / 2), 800 * 4e-3 * cell);
  // Any direction, and two that overlap.
  d.obstacles[0].center.x = 0.613, d.obstacles[0].angle = "0.4";
  EXPECT_NEAR(mass_of(d), 800 * (2 - hole), 1e-4 * 1600);
  d.obstacles.push_back(d.obstacles[0]);
  EXPECT_NEAR(mass_of(d), 800 * (2 - hole), 1e-4 * 1600) << "the same place twice";
  d.obstacles = {ObstacleDef{.center = {0.6, 0.7, 0}, .radius = 0.2}};
  EXPECT_NEAR(mass_of(d), 800 * (2 - std::numbers::pi * 0.04), 1e-5 * 1600);
  d = fluid_box({40, 20, 30});
  d.obstacles = {ObstacleDef{.center = {0.6, 0.7, 0.8}, .radius = 0.3}};
  EXPECT_NEAR(mass_of(d), 800 * (3 - 4 * std::numbers::pi / 3 * 0.027), 1e-5 * 2400);
}

TEST(GridFluidMass, StaysWhileAnObstacleMovesAndFollowsItOut) {
  GridFluidDef d = fluid_box({40, 20});
  d.advection = GridFluidDef::Advection::maccormack;
  d.obstacles = {ObstacleDef{.center = {0.6, 0.7, 0}, .radius = 0.2}};
  d.obstacles[0].displacement = {"0.5*t", "0"};
  GridFlow run(d, 0.02);
  for (int k = 0; k < 5; ++k) {
    run.steps(5);
    EXPECT_NEAR(run.observed("mass"), 800 * (2 - std::numbers::pi * 0.04), 1e-5 * 1600);
  }
  d.obstacles[0].displacement = {"10*t", "0"};
  d.sides.y_max = FlowSideDef{SideKind::outflow, {}};
  GridFlow leaves(d, 0.02);
  leaves.steps(10);
  EXPECT_NEAR(leaves.observed("mass"), 1600, 1e-9) << "it has left the box";
}

TEST(GridFluidMass, OfTwoFluidsIsTheirSumAndStays) {
  for (const size_t dimensions : {2, 3}) {
    GridFluidDef d =
        fluid_box(dimensions == 2 ? std::vector<int64_t>{32, 16} : std::vector<int64_t>{16, 8, 12});
    d.all = FlowSideDef{SideKind::slip, {}};
    d.second_fluid = SecondFluidDef{"y - 0.63 - 0.2*x", 80, {}};
    GridFlow run(d, 0.01, 1, {0, -9.81, 0});
    const double all = dimensions == 2 ? 2 : 3, start = run.observed("mass");
    const auto sum = [&] {
      const double second = run.observed("second_fluid.volume");
      return 800 * (all - second) + 80 * second;
    };
    EXPECT_NEAR(start / sum(), 1, 1e-13);
    run.steps(40);
    EXPECT_NEAR(run.observed("mass") / sum(), 1, 1e-13);
    EXPECT_NEAR(run.observed("mass") / start, 1, 1e-12);
    EXPECT_GT(run.observed("energy.kinetic"), 1) << "control: it moves";
  }
}

}  // namespace
}  // namespace truestep::test
