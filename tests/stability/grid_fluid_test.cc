// Difficult flows on a grid: steps a hundred times too long, swirls of any speed, layers at rest, obstacles
// that fill the box or only touch it.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

GridFluidDef cavity(A advection) {
  GridFluidDef d;
  d.cells = {32, 32};
  d.viscosity = 1e-3;
  d.advection = advection;
  d.sides.y_max = FlowSideDef{SideKind::wall, {"1", "0"}};
  return d;
}

TEST(GridFluidStability, StepsAHundredTimesTooLongAreDivided) {
  for (const A advection : {A::central, A::semi_lagrangian, A::maccormack, A::bfecc}) {
    GridFlow run(cavity(advection), 3);
    run.steps(20);
    // Bounded by the lid's speed: kinetic energy of at most 1/2 m^2/s^2 over the box.
    EXPECT_LT(run.observed("energy.kinetic"), 0.5);
    EXPECT_LT(run.observed("divergence.max"), 1e-10);
    const double substeps = advection == A::central ? 50 : 10;
    EXPECT_GT(run.observed("substeps"), substeps);
  }
}

TEST(GridFluidStability, StepsBeyondAllSubstepsAreRefusedWithOneThatWorks) {
  GridFluidDef d = cavity(A::central);
  d.initial = {"1e6*sin(pi*x)^2*sin(2*pi*y)", "-1e6*sin(2*pi*x)*sin(pi*y)^2"};
  GridFlow run(d, 1);
  try {
    run.steps(1);
    FAIL() << "a million cells in a step";
  } catch (const Instability& e) {
    ASSERT_GT(e.suggested_dt, 0);
    GridFlow shorter(d, e.suggested_dt);
    shorter.steps(1);
    EXPECT_TRUE(std::isfinite(shorter.observed("energy.kinetic")));
  }
}

// From rest, in one step: substeps that were as long as the fluid at rest allowed were some ten times too
// long soon afterwards, and the answer never came.
TEST(GridFluidStability, LongStepsOfTwoFluidsAreDividedAgainOnTheWay) {
  for (const auto stepping : {GridFluidDef::Stepping::rk3, GridFluidDef::Stepping::ab2}) {
    GridFluidDef d;
    d.cells = {24, 24};
    d.stepping = stepping;
    d.all = FlowSideDef{SideKind::slip, {}};
    d.viscosity = 1e-4;
    d.second_fluid.emplace();
    d.second_fluid->where = "x-0.5", d.second_fluid->density = 10;
    const Vec3 down{0, -9.81, 0};
    GridFlow whole(d, 1.67, 1, down);
    const double before = whole.observed("energy.gravity"), volume = whole.observed("second_fluid.volume");
    whole.steps(1);
    GridFlow parts(d, 0.0167, 1, down);
    parts.steps(100);
    const double fell = before - whole.observed("energy.gravity"), moves = whole.observed("energy.kinetic");
    std::printf("  %g substeps, cfl %.2f, fell %.2f J (in a hundred steps %.2f), moves %.2f J (%.2f)\n",
                whole.observed("substeps"), whole.observed("cfl"), fell,
                before - parts.observed("energy.gravity"), moves, parts.observed("energy.kinetic"));
    EXPECT_LT(whole.observed("cfl"), 1.8) << "at the end";
    EXPECT_LT(whole.observed("substeps"), GridFluid::kMostSubsteps);
    EXPECT_LT(moves, fell) << "no energy from nothing";
    EXPECT_GT(moves, 0) << "it flows";
    EXPECT_NEAR(whole.observed("second_fluid.volume"), volume, 1e-9);
    // The heavy fluid has sloshed from one side to the other by then, as it does in short steps.
    EXPECT_NEAR(fell, before - parts.observed("energy.gravity"), 0.2 * fell);
    // Control: substeps as long as rest allows, 41 of them, would be too long.
    EXPECT_GT(whole.observed("substeps"), 100);
  }
}

// A blob of smoke at rest, in one step: from the speed at rest a single substep would do, after which it had
// moved at 2,000 m/s.
TEST(GridFluidStability, LongStepsOfWhatRisesFromRestAreDivided) {
  for (const A advection : {A::central, A::maccormack}) {
    GridFluidDef d;
    d.cells = {32, 48};
    d.size = {1, 1.5};
    d.origin = Vec3{-0.5, 0, 0};
    d.advection = advection;
    d.all = FlowSideDef{SideKind::slip, {}};
    d.scalar = ScalarDef{.initial = "x^2+(y-0.4)^2<0.05 ? 1 : 0", .expansion = 0.3};
    const Vec3 down{0, -9.81, 0};
    GridFlow whole(d, 1.67, 1, down), parts(d, 0.0167, 1, down);
    whole.steps(1), parts.steps(100);
    const double moves = whole.observed("energy.kinetic"), in_parts = parts.observed("energy.kinetic");
    std::printf("  %g substeps, moves %.3f J (in a hundred steps %.3f)\n", whole.observed("substeps"), moves,
                in_parts);
    // Control: at rest one would do.
    EXPECT_GT(whole.observed("substeps"), 10);
    // Paths are of first order in time.
    EXPECT_NEAR(moves, in_parts, (advection == A::central ? 0.1 : 0.5) * in_parts);
  }
}

TEST(GridFluidStability, LightAboveHeavyStaysAtRest) {
  for (const A advection : {A::central, A::maccormack}) {
    GridFluidDef d;
    d.cells = {32, 48};
    d.advection = advection;
    d.scalar = ScalarDef{.initial = "y", .expansion = 1};
    GridFlow run(d, 0.02, 1, Vec3{0, -9.81, 0});
    run.steps(500);
    EXPECT_LT(run.observed("speed.max"), 1e-10);  // rounding of 10 m/s^2 oscillates but does not grow
    // Control: upside down it falls.
    d.scalar->initial = "-y + 0.01*cos(pi*x)";
    GridFlow falling(d, 0.02, 1, Vec3{0, -9.81, 0});
    falling.steps(100);
    EXPECT_GT(falling.observed("speed.max"), 0.1);
  }
}

TEST(GridFluidStability, ObstaclesMayFillTheBoxOrOnlyTouchIt) {
  for (const double radius : {0.01, 0.499, 0.5, 0.70, 5.0}) {
    GridFluidDef d = cavity(A::central);
    d.obstacles = {ObstacleDef{.center = {0.5, 0.5, 0}, .radius = radius}};
    GridFlow run(d, 0.05);
    run.steps(10);
    EXPECT_TRUE(std::isfinite(run.observed("energy.kinetic"))) << radius;
    EXPECT_TRUE(std::isfinite(run.observed("obstacle.drag"))) << radius;
    EXPECT_LT(run.observed("speed.max"), 10) << radius;
  }
}

}  // namespace
}  // namespace truestep::test
