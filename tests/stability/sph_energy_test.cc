// Energy from nothing in a liquid ends a session with an event, and what a liquid may do does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

std::string liquid(const std::string& members, const std::string& gravity = "[0, -9.81, 0]") {
  return R"({"gravity": )" + gravity +
         R"(, "time": {"dt": 0.016666666666666666}, "systems": [{"type": "sph", "id": "w",
      "low": [0, 0, 0], "high": [1, 1, 1], "spacing": 0.05, )" +
         members + "}]}";
}

/// Bodies in one place: as many times the liquid's density.
std::string crushed(const std::string& solver, int times) {
  std::string bodies;
  for (int k = 0; k < times; ++k) {
    bodies += std::string(k ? ", " : "") + R"({"center": [0.5, )" + std::to_string(0.15 + 1e-4 * k) +
              R"(, 0.5], "half_extents": [0.15, 0.15, 0.15]})";
  }
  return R"("solver": ")" + solver + R"(", "bodies": [)" + bodies + "]";
}

// Both went on with over a hundred times the energy.
TEST(SphEnergy, ABurstEndsWithAnEvent) {
  const std::pair<const char*, int> cases[] = {{"pbf", 4}, {"wcsph", 9}};
  for (const auto& [solver, times] : cases) {
    SceneRun run(liquid(crushed(solver, times)));
    EXPECT_LT(run.session.step(60), 60u) << solver;
    ASSERT_TRUE(run.session.failure().has_value()) << solver;
    EXPECT_THAT(run.session.failure()->detail, testing::HasSubstr("energy rose from")) << solver;
    EXPECT_EQ(run.session.failure()->quantity, "energy") << solver;
  }
  // The control: dfsph separates them without a burst.
  SceneRun held(liquid(crushed("dfsph", 4)));
  const double before = held.observe("energy.total");
  EXPECT_EQ(held.session.step(60), 60u);
  EXPECT_LT(held.observe("energy.total"), before);
}

// A column that falls, a drop without weight that its surface pulls together, two jets that meet, and a kick.
TEST(SphEnergy, WhatALiquidDoesIsNone) {
  const std::string column = R"("bodies": [{"center": [0.2, 0.4, 0.5], "half_extents": [0.2, 0.4, 0.5]}])";
  const std::string jets = R"("bodies": [
      {"center": [0.2, 0.5, 0.5], "half_extents": [0.2, 0.1, 0.1], "velocity": [5, 0, 0]},
      {"center": [0.8, 0.5, 0.5], "half_extents": [0.2, 0.1, 0.1], "velocity": [-5, 0, 0]}])";
  for (const char* solver : {"dfsph", "wcsph", "pbf"}) {
    const std::string by = std::string(R"("solver": ")") + solver + "\", ";
    EXPECT_EQ(SceneRun(liquid(by + column)).session.step(60), 60u) << solver;
    EXPECT_EQ(SceneRun(liquid(by + jets)).session.step(60), 60u) << solver;
    EXPECT_EQ(SceneRun(liquid(by + column, "[0, 0, 0]")).session.step(60), 60u) << solver;
    // Half a spacing wider than a whole number of them.
    const std::string uneven =
        R"("bodies": [{"center": [0.3, 0.3, 0.3], "half_extents": [0.1875, 0.1875, 0.1875]}])";
    EXPECT_EQ(SceneRun(liquid(by + uneven, "[0, 0, 0]")).session.step(60), 60u) << solver;
  }
  const std::string drop =
      R"("surface_tension": 5, "surface_tension_model": "interface", "kernel": "wendland_c2",
      "support": 3, "bodies": [{"center": [0.5, 0.5, 0.5], "half_extents": [0.3, 0.15, 0.15]}])";
  EXPECT_EQ(SceneRun(liquid(drop, "[0, 0, 0]")).session.step(60), 60u);
  SceneRun kicked(liquid(column));
  kicked.session.step(16);
  Command kick;
  kick.system = "w", kick.kind = CommandKind::impulse, kick.index = 3, kick.vector = {100, 0, 0};
  kicked.session.post(kick);
  EXPECT_EQ(kicked.session.step(32), 32u) << "a command's energy is no surprise";
}

// What lies still in a box that moves is given energy without a source in the liquid.
TEST(SphEnergy, WallsThatMoveMakeItOpen) {
  const auto energy = [](const std::string& more) {
    SceneRun run(
        liquid(R"("bodies": [{"center": [0.5, 0.2, 0.5], "half_extents": [0.5, 0.2, 0.5]}])" + more));
    Workspace workspace;
    return run.world->system(0)
        .energy(run.session.state().systems[0], 0, workspace, ThreadArena(1))
        ->exchange;
  };
  EXPECT_EQ(energy(""), Energy::Exchange::closed);
  const std::string paddle = R"(, "colliders": [{"type": "sphere", "center": [0.5, 0.8, 0.5], "radius": 0.1)";
  EXPECT_EQ(energy(paddle + "}]"), Energy::Exchange::closed) << "at rest";
  EXPECT_EQ(energy(paddle + R"(, "motion": {"velocity": [1, 0, 0]}}])"), Energy::Exchange::open);
  EXPECT_EQ(energy(R"(, "vorticity": 1)"), Energy::Exchange::open);
  EXPECT_EQ(energy(R"(, "emitters": [{"position": [0.5, 0.8, 0.5], "speed": 1, "radius": 0.1}])"),
            Energy::Exchange::open);
}

}  // namespace
}  // namespace truestep
