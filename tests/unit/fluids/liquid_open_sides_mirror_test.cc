// An open side lets liquid out in the same way at both ends of an axis.
#include <gtest/gtest.h>

#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

// kg, left of half a box of water after 0.3 s beside one open side.
double left(size_t axis, bool upper) {
  GridFluidDef d = water(GridFluidDef::Advection::apic, {16, 16, 4}, 1.0 / 16);
  const Vec3 low = axis == 0 && upper ? Vec3{0.5, 0, 0} : Vec3{0, 0, 0};
  d.bodies = {box_of_liquid(axis == 0 ? low : Vec3{0, upper ? 0.5 : 0, 0},
                            axis == 0 ? low + Vec3{0.5, 1, 0.25} : Vec3{1, upper ? 1 : 0.5, 0.25})};
  const FlowSideDef open{SideKind::outflow, {}};
  (axis == 0 ? upper ? d.sides.x_max : d.sides.x_min : upper ? d.sides.y_max : d.sides.y_min) = open;
  // Pulled out by a weight along the axis.
  const double g = upper ? 9.81 : -9.81;
  LiquidRun run(d, 0.01, 1, axis == 0 ? Vec3{g, 0, 0} : Vec3{0, g, 0});
  run.steps(30);
  return run.observed("mass");
}

TEST(LiquidOpenSidesMirror, BothEndsLetAsMuchOut) {
  for (const size_t axis : {0, 1}) {
    const double below = left(axis, false), above = left(axis, true);
    EXPECT_LT(below, 0.3 * 125) << "control: most of it has fallen out";
    EXPECT_NEAR(above, below, 0.01 * 125) << "axis " << axis;
  }
}

}  // namespace
}  // namespace truestep::test
