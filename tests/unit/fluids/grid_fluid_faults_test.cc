// Errors in a scene or a command of a fluid on a grid are reported with their place.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/fluids/grid_flow.h"
#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

std::string pointer_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.issues().empty() ? "" : e.issues()[0].pointer;
  }
  return "nothing was refused";
}

std::vector<std::string> reported(const GridFluidDef& d) {
  std::vector<std::string> out;
  grid_fluid_table().check(&d,
                           [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

TEST(GridFluidFaults, TextsAreRefusedWithTheirPlace) {
  GridFluidDef d;
  d.cells = {8, 8};
  d.initial = {"x", "oops"};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/initial/1");
  d.initial.clear();
  d.sides.x_min = FlowSideDef{SideKind::inflow, {"1", "1 +"}};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/sides/x_min/velocity/1");
  // More inflow than outflow.
  d.sides.x_min->velocity = {"1", "0"};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/sides");
  d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "nothing was refused");
}

TEST(GridFluidFaults, WhatTwoFluidsLackIsReported) {
  using List = std::vector<std::string>;
  GridFluidDef d;
  d.cells = {8, 8};
  d.second_fluid = SecondFluidDef{"y - 0.5", 10, 0.1};
  EXPECT_EQ(reported(d), List{});
  d.obstacles = {ObstacleDef{}};
  EXPECT_EQ(reported(d), List{"/obstacles"});
  d.obstacles.clear();
  d.sides.x_min = FlowSideDef{SideKind::inflow, {"1", "0"}};
  EXPECT_EQ(reported(d), List{"/sides/x_min/kind"});
  d.sides = {}, d.second_fluid->density = 2000;
  EXPECT_EQ(reported(d), List{"/second_fluid/density"});
  d.second_fluid->density = 10, d.viscous = GridFluidDef::Viscous::implicit;
  EXPECT_EQ(reported(d), List{"/viscous"});
  d.viscous = GridFluidDef::Viscous::automatic, d.advection = GridFluidDef::Advection::bfecc;
  EXPECT_EQ(reported(d), List{"/second_fluid/viscosity"});
  d.second_fluid->viscosity.reset();
  EXPECT_EQ(reported(d), List{});
}

TEST(GridFluidFaults, MembersThatDoNotFitAreReported) {
  using List = std::vector<std::string>;
  GridFluidDef d;
  d.cells = {8, 8};
  EXPECT_EQ(reported(d), List{});
  d.sides.x_min = FlowSideDef{SideKind::slip, {"1", "0"}};
  EXPECT_EQ(reported(d), List{"/sides/x_min/velocity"});
  d.sides.x_min = FlowSideDef{SideKind::inflow, {"1"}};
  EXPECT_EQ(reported(d), List{"/sides/x_min/velocity"});
  d.sides = {};
  d.sides.z_max = FlowSideDef{};
  EXPECT_EQ(reported(d), List{"/sides/z_max"});
  d.sides = {};
  d.force = {"1", "0", "0"};
  EXPECT_EQ(reported(d), List{"/force"});
  d.force.clear();
  d.order = GridFluidDef::Order::fourth;
  d.all = FlowSideDef{SideKind::slip, {}};
  EXPECT_EQ(reported(d), List{});
  d.sides.x_max = FlowSideDef{SideKind::wall, {}};
  EXPECT_EQ(reported(d), List{"/sides/x_max/kind"});
  d.sides = {}, d.obstacles = {ObstacleDef{}};
  EXPECT_EQ(reported(d), List{"/order"});
  d.order = GridFluidDef::Order::second, d.obstacles[0].displacement = {"t"};
  EXPECT_EQ(reported(d), List{"/obstacles/0/displacement"});
  d.obstacles[0].displacement = {"t", "x"};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/obstacles/0/displacement/1");
  d.obstacles[0].displacement.clear(), d.obstacles[0].angle = "2*x";
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/obstacles/0/angle");
  d.obstacles[0].angle = "2*t", d.obstacles[0].axis = {1, 0, 0};
  EXPECT_EQ(reported(d), List{"/obstacles/0/axis"});
  d.obstacles[0].axis = {};
  EXPECT_EQ(reported(d), List{"/obstacles/0/axis"});
}

TEST(GridFluidFaults, SteadyFlowsAreRefusedWhatTheyDoNotHave) {
  using List = std::vector<std::string>;
  GridFluidDef d;
  d.cells = {8, 8}, d.viscosity = 0.1;
  d.stepping = GridFluidDef::Stepping::steady;
  EXPECT_EQ(reported(d), List{});
  const auto with = [&](auto change) {
    GridFluidDef other = d;
    change(other);
    return reported(other);
  };
  EXPECT_EQ(with([](auto& o) { o.viscosity = 0; }), List{"/viscosity"});
  EXPECT_EQ(with([](auto& o) { o.cells = {8, 8, 8}; }), List{"/cells"});
  EXPECT_EQ(with([](auto& o) { o.cells = {600, 600}; }), List{"/cells"});
  EXPECT_EQ(with([](auto& o) { o.obstacles = {ObstacleDef{}}; }), List{"/obstacles"});
  EXPECT_EQ(with([](auto& o) { o.scalar = ScalarDef{}; }), List{"/scalar"});
  EXPECT_EQ(with([](auto& o) { o.initial = {"0", "0"}; }), List{"/initial"});
  EXPECT_EQ(with([](auto& o) { o.cfl = 1; }), List{"/cfl"});
  EXPECT_EQ(with([](auto& o) { o.viscous = GridFluidDef::Viscous::implicit; }), List{"/viscous"});
  EXPECT_EQ(with([](auto& o) { o.advection = GridFluidDef::Advection::maccormack; }), List{"/advection"});
  EXPECT_EQ(with([](auto& o) {
              o.sides.x_max = FlowSideDef{SideKind::outflow, {}};
            }),
            List{"/sides/x_max/kind"});
  d.sides.y_max = FlowSideDef{SideKind::wall, {"t", "0"}};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/sides/y_max/velocity");
  d.sides.y_max->velocity = {"x", "0"};
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "nothing was refused");
  d.order = GridFluidDef::Order::fourth;
  EXPECT_EQ(pointer_of([&] { GridFlow run(d, 0.1); }), "/sides/y_max/velocity");
  d.sides.y_max->velocity = {"1", "0"};
  GridFlow run(d, 0.1);
  run.steps(1);
  const auto refused = [&](Command c) { return pointer_of([&] { run.system->apply(run.state, c); }); };
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}}), "/type");
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = 0, .name = "viscosity"}), "/value");
}

TEST(GridFluidFaults, LiquidsAreRefusedWhatTheyDoNotHave) {
  using List = std::vector<std::string>;
  using A = GridFluidDef::Advection;
  const auto apic = [] {
    GridFluidDef d = water(A::apic, {8, 8}, 0.125);
    d.bodies = {box_of_liquid({0, 0, -1}, {0.5, 0.5, 1})};
    return d;
  };
  GridFluidDef d = apic();
  EXPECT_EQ(reported(d), List{});
  d.bodies.clear();
  EXPECT_EQ(reported(d), List{"/bodies"});
  d = apic(), d.advection = A::central;
  EXPECT_EQ(reported(d), List{"/bodies"});
  d = apic(), d.obstacles = {ObstacleDef{}}, d.obstacles[0].displacement = {"t", "0"};
  EXPECT_EQ(reported(d), List{});
  d.obstacles[0].displacement = {"t"};
  EXPECT_EQ(reported(d), List{"/obstacles/0/displacement"});
  d = apic(), d.scalar = ScalarDef{};
  EXPECT_EQ(reported(d), List{"/scalar"});
  d = apic(), d.size = {1, 2};
  EXPECT_EQ(reported(d), List{"/size"});
  d = apic(), d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
  EXPECT_EQ(reported(d), List{}) << "open sides it has";
  d.sides.x_max->velocity = {"1", "0"};
  EXPECT_EQ(reported(d), List{"/sides/x_max/velocity"});
  d.sides.x_max = FlowSideDef{SideKind::wall, {"0", "1"}};
  EXPECT_EQ(reported(d), List{"/sides/x_max/velocity"}) << "walls that move it would not feel";
  d.sides.x_max = FlowSideDef{SideKind::inflow, {"1"}};
  EXPECT_EQ(reported(d), List{"/sides/x_max/velocity"}) << "a component is missing";
  d.sides.x_max = FlowSideDef{SideKind::inflow, {"-1", "0"}}, d.bodies.clear();
  EXPECT_EQ(reported(d), List{}) << "what flows in is liquid enough";
  d = apic(), d.bodies[0].velocity = {0, 0, 1};
  EXPECT_EQ(reported(d), List{"/bodies/0/velocity"});
  // Outside of the box.
  d = apic(), d.bodies[0].center = {5, 5, 0};
  EXPECT_EQ(pointer_of([&] { LiquidRun run(d, 0.1); }), "/bodies");
}

TEST(GridFluidFaults, CommandsToALiquidAreRefused) {
  GridFluidDef d = water(GridFluidDef::Advection::flip, {8, 8}, 0.125);
  d.bodies = {box_of_liquid({0, 0, -1}, {0.5, 0.5, 1})};
  LiquidRun run(d, 0.1);
  const auto refused = [&](Command c) { return pointer_of([&] { run.system->apply(run.state, c); }); };
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = 1, .name = "viscosity"}), "/type");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .index = 0, .vector = {1, 0, 1}}), "/vector");
}

TEST(GridFluidFaults, AStepAThousandTimesTooLongSaysWhatWorks) {
  GridFluidDef d = water(GridFluidDef::Advection::flip, {8, 8}, 0.125);
  d.bodies = {box_of_liquid({0, 0, -1}, {0.5, 0.5, 1})};
  d.bodies[0].velocity = {1, 0, 0};
  LiquidRun run(d, 1000);
  try {
    run.steps(1);
    ADD_FAILURE() << "nothing was refused";
  } catch (const Instability& e) {
    // 9.81 m/s^2 for a step of 10 s cross 785 cells.
    EXPECT_GT(e.suggested_dt, 0.01);
    EXPECT_LT(e.suggested_dt, 10);
    LiquidRun again(d, e.suggested_dt);
    again.steps(1);
    EXPECT_GT(again.observed("energy.kinetic"), 0);
  }
}

// Steps a hundred times too long for a substep are subdivided, or refused with a step that works; never NaN.
TEST(GridFluidFaults, StepsFarTooLongAreDividedOrSayWhatWorks) {
  using A = GridFluidDef::Advection;
  for (const A advection : {A::central, A::semi_lagrangian, A::maccormack, A::bfecc}) {
    for (const bool obstacle : {false, true}) {
      for (const double viscosity : {0.0, 1e-3, 0.1, 10.0}) {
        GridFluidDef d;
        d.cells = {16, 16};
        d.advection = advection, d.viscosity = viscosity;
        d.sides.y_max = FlowSideDef{SideKind::wall, {"1", "0"}};
        if (obstacle) d.obstacles = {ObstacleDef{.center = {0.5, 0.5, 0}, .radius = 0.2}};
        // The lid crosses 16 cells a second.
        double dt = 100 * 1.2 / 16;
        for (int attempt = 0; attempt < 2; ++attempt) {
          GridFlow run(d, dt);
          try {
            run.steps(2);
            EXPECT_TRUE(std::isfinite(run.observed("energy.kinetic")));
            EXPECT_LT(run.observed("speed.max"), 2) << "the lid's speed, and some";
            break;
          } catch (const Instability& e) {
            ASSERT_EQ(attempt, 0) << "the step that was said to work does";
            ASSERT_GT(e.suggested_dt, 0);
            dt = e.suggested_dt;
          }
        }
      }
    }
  }
}

TEST(GridFluidFaults, CommandsAreRefused) {
  GridFluidDef d;
  d.cells = {8, 8};
  GridFlow run(d, 0.1);
  const auto refused = [&](Command c) { return pointer_of([&] { run.system->apply(run.state, c); }); };
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = 1, .name = "colour"}), "/name");
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = -1, .name = "viscosity"}), "/value");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}}), "/at");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}, .at = Vec3{2, 0, 0}}), "/at");
  EXPECT_EQ(refused({.kind = CommandKind::pin}), "/type");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}, .at = Vec3{0.5, 0.5, 0}}),
            "nothing was refused");
  EXPECT_GT(run.observed("energy.kinetic"), 0);
}

}  // namespace
}  // namespace truestep::test
