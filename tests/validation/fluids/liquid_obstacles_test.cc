// Obstacles that the scene moves through a liquid with a surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

// Water level next to the walls: the mean of the topmost particles in the outer sixths of the tank.
double level(const LiquidRun& run, double width, double spacing) {
  std::vector<double> top(static_cast<size_t>(width / spacing), 0);
  const auto x = run.places();
  for (size_t p = 0; p < x.size() / 3; ++p) {
    auto& column = top[std::min(top.size() - 1, static_cast<size_t>(x[3 * p] / spacing))];
    column = std::max(column, x[3 * p + 1]);
  }
  double sum = 0, count = 0;
  for (size_t i = 0; i < top.size(); ++i) {
    if (i >= top.size() / 6 && i < top.size() - top.size() / 6) continue;
    sum += top[i] + 0.25 * spacing, count += 1;
  }
  return sum / count;
}

// A block is lowered into a tank: the water rises by the volume the block displaces.
TEST(LiquidObstacles, ABlockPushedIntoATankRaisesTheWater) {
  constexpr double kSpacing = 1.0 / 32, kDepth = 0.5;
  for (const A advection : {A::flip, A::apic}) {
    GridFluidDef d = water(advection, {32, 32}, kSpacing);
    d.bodies = {box_of_liquid({0, 0, -1}, {1, kDepth, 1})};
    ObstacleDef o{.shape = ObstacleDef::Shape::box, .center = {0.5, 0.8, 0}, .half = {0.2, 0.2, 1}};
    // From 0.1 m above the water to 0.2 m below its first level, then it stays.
    o.displacement = {"0", "t < 1.5 ? -0.2*t : -0.3"};
    d.obstacles = {o};
    LiquidRun run(d, 0.02);
    const double mass = run.observed("mass"), before = level(run, 1, kSpacing);
    run.steps(200);
    // The block's lower side is at 0.3 m; (1 - 0.4) rise = 0.4 (rise + 0.5 - 0.3).
    const double expected = kDepth + 0.4 * 0.2 / 0.6, after = level(run, 1, kSpacing);
    std::printf("  level %.4f to %.4f, expected %.4f; compression %.3f, speed %.3f m/s\n", before, after,
                expected, run.observed("density.mean_error"), run.observed("speed.max"));
    EXPECT_EQ(run.observed("mass"), mass);
    // A third of a cell: the surface still swings (0.0045 was seen). Control: the rise is thirteen times
    // that.
    EXPECT_NEAR(after, expected, 0.01);
    EXPECT_NEAR(before, kDepth, 0.01);
    double inside = 0;
    const auto x = run.places();
    for (size_t p = 0; p < x.size() / 3; ++p)
      inside += std::abs(x[3 * p] - 0.5) < 0.199 && x[3 * p + 1] > 0.301;
    EXPECT_EQ(inside, 0) << "particles in the block";
  }
}

}  // namespace
}  // namespace truestep::test
