// Steps of fields, flows and liquids on grids allocate in the first steps only.
#include <gtest/gtest.h>

#include "tests/determinism/allocations/allocation_count.h"
#include "tests/support/fluids/field_run.h"
#include "tests/support/fluids/grid_flow.h"
#include "tests/support/fluids/liquid_grid.h"
#include "tests/support/fluids/shallow_run.h"

namespace truestep {
namespace {

TEST(Allocation, HeatAndWavesAllocateNothingAfterTheFirstSteps) {
  const auto expect_none = [](const auto& def, const char* what) {
    test::FieldRun run(def, 1e-3);
    run.steps(2);
    EXPECT_EQ(test::allocations_of([&] { run.steps(10); }), 0u) << def.integrator << " " << what;
  };
  const auto fill = [](auto& d) {
    d.cells = {24, 20};
    d.initial = "x*y";
    d.source = "sin(t)*x";
    d.sides.x_min = test::side(lattice::SideKind::dirichlet, "sin(t)");
    d.sides.x_max = test::side(lattice::SideKind::neumann, "y*t");
    d.tolerance = 1e-4;
  };
  for (const char* method : {"euler", "rk4", "rkc2", "trapezoid", "bdf2", "sdirk4", "rodas5p", "radau5"}) {
    heat::HeatDef d;
    fill(d);
    d.integrator = method;
    expect_none(d, "by waves");
    d.diffusivity = "1 + x";
    expect_none(d, "by multigrid");
  }
  for (const char* method : {"leapfrog", "implicit_midpoint", "generalized_alpha"}) {
    wave::WaveDef d;
    fill(d);
    d.integrator = method;
    expect_none(d, "waves");
  }
}

TEST(Allocation, StepsOfAFlowOnAGridAllocateNothingAfterTheFirst) {
  using grid_fluid::GridFluidDef;
  for (const bool solid : {false, true}) {
    for (const auto advection : {GridFluidDef::Advection::central, GridFluidDef::Advection::maccormack}) {
      GridFluidDef d;
      d.cells = {24, 20};
      d.viscosity = 0.1;
      d.advection = advection;
      d.scalar =
          grid_fluid::ScalarDef{.initial = "x", .source = "sin(t)*x", .diffusivity = 0.01, .expansion = 0.1};
      d.force = {"sin(t)", "0"};
      d.sides.y_max = grid_fluid::FlowSideDef{grid_fluid::SideKind::wall, {"cos(t)", "0"}};
      if (solid) d.obstacles = {grid_fluid::ObstacleDef{.center = {0.5, 0.5, 0}, .radius = 0.2}};
      test::GridFlow run(d, 0.01);
      run.steps(2);
      EXPECT_EQ(test::allocations_of([&] { run.steps(5); }), 0u) << solid;
    }
  }
}

TEST(Allocation, StepsOfALiquidOnAGridAllocateNothingAfterTheFirst) {
  using grid_fluid::GridFluidDef;
  for (const bool space : {false, true}) {
    for (const auto advection : {GridFluidDef::Advection::flip, GridFluidDef::Advection::apic}) {
      GridFluidDef d = test::water(
          advection, space ? std::vector<int64_t>{16, 12, 8} : std::vector<int64_t>{32, 24}, 1.0 / 24);
      d.bodies = {test::box_of_liquid({0, 0, -1}, {0.25, 0.4, 1})};
      d.obstacles = {grid_fluid::ObstacleDef{.center = {0.4, 0, 0.2}, .radius = 0.1}};
      d.force = {"sin(t)", "0"};
      if (space) d.force.emplace_back("0");
      test::LiquidRun run(d, 0.01);
      run.steps(2);
      EXPECT_EQ(test::allocations_of([&] { run.steps(10); }), 0u) << space;
    }
  }
}

TEST(Allocation, StepsOfALiquidThatComesAndGoesAllocateNothingAfterTheFirst) {
  using namespace grid_fluid;
  for (const auto advection : {GridFluidDef::Advection::flip, GridFluidDef::Advection::apic}) {
    GridFluidDef d = test::water(advection, {32, 32}, 1.0 / 32);
    d.bodies = {test::box_of_liquid({0, 0, -1}, {1, 0.3, 1})};
    d.obstacles = {ObstacleDef{.center = {0.5, 0.2, 0}, .radius = 0.1}};
    LiquidInletDef e;
    e.position = {0.3, 0.6, 0}, e.direction = {1, 1, 0};
    d.emitters = {e};
    d.sides.x_min = FlowSideDef{SideKind::inflow, {"y < 0.2 ? 1 : 0", "0"}};
    d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
    d.kill_planes = {{.point = {0, 0.02, 0}, .normal = {0, 1, 0}}};
    test::LiquidRun run(d, 0.01);
    run.steps(20);
    EXPECT_EQ(test::allocations_of([&] { run.steps(10); }), 0u);
    EXPECT_GT(run.observed("left"), 0) << "control: it does";
    EXPECT_GT(run.observed("emitted"), 0);
  }
}

TEST(Allocation, StepsOfShallowWaterAllocateNothingAfterTheFirst) {
  for (const size_t dimensions : {1, 2}) {
    heightfield_wave::HeightfieldWaveDef d;
    d.cells.assign(dimensions, 24);
    d.surface = "x < 0.5 ? 1 : 0";
    d.friction = 0.01;
    test::ShallowRun run(d, 0.05);
    run.steps(2);
    EXPECT_EQ(test::allocations_of([&] { run.steps(5); }), 0u) << dimensions;
  }
}

}  // namespace
}  // namespace truestep
