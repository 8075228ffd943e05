// Liquids of flip and apic that flow in and out through sides of their box.
#include <gtest/gtest.h>

#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;
constexpr double kWeight = 9.81;

FlowSideDef inflow_side(std::vector<std::string> velocity) {
  return {SideKind::inflow, std::move(velocity)};
}
const FlowSideDef kOutflow{SideKind::outflow, {}};

// Without gravity a box fills by a front that moves at the inflow's speed; then as much leaves as comes in,
// and nothing changes.
TEST(LiquidOpenSides, AStreamFillsAndLeavesABox) {
  for (const A advection : {A::flip, A::apic}) {
    for (const bool space : {false, true}) {
      for (const bool along_y : {false, true}) {
        GridFluidDef d = water(
            advection, space ? std::vector<int64_t>{16, 16, 8} : std::vector<int64_t>{16, 16}, 1.0 / 16);
        std::vector<std::string> velocity(space ? 3 : 2, "0");
        velocity[along_y ? 1 : 0] = along_y ? "-1" : "1";
        (along_y ? d.sides.y_max : d.sides.x_min) = inflow_side(velocity);
        (along_y ? d.sides.y_min : d.sides.x_max) = kOutflow;
        LiquidRun run(d, 0.02, 1, {});
        run.steps(25);  // half a box
        const double mass = space ? 500 : 1000, layer = 1.0 / 32;
        EXPECT_NEAR(run.observed("mass"), 0.5 * mass, 1e-9);
        // As a front of particles passes, walls and surface see it a little more and less than full.
        EXPECT_NEAR(along_y ? 1 - run.observed("low.y") : run.observed("high.x"), 0.5 - layer / 2, layer / 2);
        run.steps(75);
        EXPECT_NEAR(run.observed("mass"), mass, layer * mass);
        EXPECT_NEAR(run.observed("emitted") - run.observed("left"), run.observed("count"), 0);
        EXPECT_GT(run.observed("left"), 0.4 * run.observed("count")) << "control: half a box has gone";
        EXPECT_NEAR(run.observed("speed.max"), 1, 1e-6) << "a plug that nothing holds back";
      }
    }
  }
}

// Part of a side, a flow that depends on time, and one that is drawn out.
TEST(LiquidOpenSides, AsMuchFlowsAsTheGivenVelocitySays) {
  for (const A advection : {A::flip, A::apic}) {
    GridFluidDef d = water(advection, {32, 24}, 1.0 / 32);
    d.bodies = {box_of_liquid({0, 0, -1}, {1, 0.25, 1})};
    d.sides.x_min = inflow_side({"y < 0.25 ? 0.4*sin(pi*t)^2 : 0", "0"});
    d.sides.x_min->dye = 1;
    LiquidRun run(d, 0.01);
    run.steps(200);
    // The mean of sin^2 is 1/2; 16 rows of particles, each to within one.
    const double in = 0.25 * 0.4 * 0.5 * 2, particle = 1.0 / 64 / 64;
    EXPECT_NEAR(run.observed("emitted") * particle, in, 17 * particle);
    EXPECT_NEAR(run.observed("dye.total"), run.observed("emitted") * particle, 1e-12);
    EXPECT_NEAR(run.observed("mass"), 1000 * (0.25 + run.observed("dye.total")), 1e-6);
    // As deep as this makes it: half of 0.35 m, with what waves lift.
    EXPECT_NEAR(run.observed("centre.y"), 0.175, 0.02 * 0.175 + 0.004);
    EXPECT_LT(run.observed("density.mean_error"), 0.02);

    // Drawn out at the floor of the other side.
    d.sides.x_min.reset(), d.sides.x_max = inflow_side({"y < 0.125 ? 0.5 : 0", "0"});
    LiquidRun drained(d, 0.01);
    drained.steps(200);
    EXPECT_EQ(drained.observed("emitted"), 0);
    // Of 0.25 m^2, to within 4 %: the surface is drawn to the opening, where cells are not full.
    EXPECT_NEAR(drained.observed("left") * particle, 0.125, 0.04 * 0.125);
    EXPECT_NEAR(drained.observed("mass"), 1000 * (0.25 - drained.observed("left") * particle), 1e-6);
  }
}

// Water that shoots over an edge: where the pressure is 0 down to the floor, momentum per width, q u + g h^2
// / 2, is q u alone. So its depth is h0 2 F^2 / (1 + 2 F^2) there, F the Froude number upstream (Rouse 1936,
// "Discharge characteristics of the free overfall").
TEST(LiquidOpenSides, AStreamThinsWhereItFallsOverAnEdge) {
  constexpr double kDepth = 0.25, kFroude = 2;
  for (const A advection : {A::flip, A::apic}) {
    const double u = kFroude * std::sqrt(kWeight * kDepth);
    GridFluidDef d = water(advection, {64, 24}, kDepth / 16);
    d.bodies = {box_of_liquid({0, 0, -1}, {1, kDepth, 1})};
    d.bodies[0].velocity = {u, 0, 0};
    d.sides.x_min = inflow_side({"y < 0.25 ? " + std::to_string(u) + " : 0", "0"});
    d.sides.x_max = kOutflow;
    LiquidRun run(d, 0.005);
    run.steps(200);
    // Depth 0.6 m before the edge, by what is there; at the edge by how fast it is.
    const double cell = kDepth / 16, particle = cell * cell / 4;
    double before = 0, count = 0, fast = 0;
    for (int k = 0; k < 100; ++k) {
      run.steps(1);
      const auto x = run.places(), v = run.velocities();
      for (size_t i = 0; i < x.size() / 3; ++i) {
        before += x[3 * i] > 0.4 && x[3 * i] < 0.4 + 8 * cell ? 0.01 * particle / (8 * cell) : 0;
        if (x[3 * i] > 1 - cell) fast += v[3 * i], count += 1;
      }
    }
    const double theory = 2 * kFroude * kFroude / (1 + 2 * kFroude * kFroude), thinned = u / (fast / count);
    std::printf("  depth %.4f before, at the edge %.4f of it; theory %.4f\n", before, thinned, theory);
    // Steps of nearly a cell leave ripples of 2 % behind.
    EXPECT_NEAR(before, kDepth, 0.02 * kDepth);
    // On average half a cell before the edge.
    EXPECT_NEAR(thinned, theory, 0.03);
    EXPECT_LT(thinned, 0.96) << "control: a side that went on like the channel would leave 1";
  }
}

// A pool behind a side that opens runs out of it, and takes its energy along.
TEST(LiquidOpenSides, APoolRunsOut) {
  for (const A advection : {A::flip, A::apic}) {
    GridFluidDef d = water(advection, {32, 24, 8}, 1.0 / 32);
    d.bodies = {box_of_liquid({0, 0, -1}, {1, 0.5, 1})};
    d.sides.x_max = kOutflow;
    LiquidRun run(d, 0.01);
    const double mass = run.observed("mass");
    double energy = run.observed("energy.total");
    for (int k = 0; k < 10; ++k) {
      run.steps(15);
      EXPECT_LT(run.observed("energy.total"), 1.001 * energy);
      energy = run.observed("energy.total");
    }
    EXPECT_LT(run.observed("mass"), 0.35 * mass);
    EXPECT_GT(run.observed("mass"), 0.02 * mass);
    EXPECT_LT(run.observed("speed.max"), 1.1 * 2 * std::sqrt(kWeight * 0.5))
        << "no faster than a dam break's tip";
  }
}

}  // namespace
}  // namespace truestep::test
