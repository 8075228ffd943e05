// Bounces that accumulate end in contact: the ball stays on its floor however long the run, rides a moving
// floor, leaves one that drops away, and moves again when something moves it.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/support/ode_run.h"

namespace truestep::test {
namespace {

std::string ball(const std::string& restitution, const std::string& method = "dopri5",
                 const std::string& more = "") {
  return R"s("states": {"h": 1, "v": 0}, "parameters": {"g": 9.81, "e": )s" + restitution +
         R"s(}, "equations": {"h": "v", "v": "-g"}, "integrator": ")s" + method +
         R"s(", "events": [{"name": "bounce", "when": "h", "direction": "falling", "set": {"v": "-e * v"}})s" +
         more + "]";
}

TEST(OdeBouncesComeToRest, WhateverTheRestitutionMethodAndStep) {
  for (const char* method : {"dopri5", "tsit5", "dop853", "rk4", "radau5", "implicit_midpoint"}) {
    for (const char* e : {"0", "0.3", "0.8", "0.95"}) {
      for (const double dt : {0.1, 1.0 / 60, 0.001}) {
        OdeRun run(ball(e, method), dt);
        double lowest = 0;
        for (int k = 0; k < 20 / dt; ++k) lowest = std::min(lowest, run.steps(1).value("h"));
        // Events are known to rounding; the default tolerance is 1e-8.
        EXPECT_GT(lowest, -1e-9) << method << ' ' << e << ' ' << dt;
        EXPECT_NEAR(run.value("h"), 0, 1e-8) << method << ' ' << e << ' ' << dt;
        EXPECT_NEAR(run.value("v"), 0, 1e-12) << method << ' ' << e << ' ' << dt;
        EXPECT_EQ(run.value("events.bounce.resting"), 1);
        if (std::string(method) != "dopri5") break;
      }
    }
  }
}

TEST(OdeBouncesComeToRest, TheTimeIsThatOfTheGeometricSum) {
  // The last bounce is at fall (1 + 2 e + 2 e^2 ...) = fall (1 + e) / (1 - e), here 4.06 s.
  const double fall = std::sqrt(2 / 9.81), last = fall * 1.8 / 0.2;
  OdeRun run(ball("0.8"), 0.001);
  int steps = 0;
  while (run.value("events.bounce.resting") == 0 && steps < 10000) run.steps(1), ++steps;
  EXPECT_NEAR(0.001 * steps, last, 2e-3);
  const double bounces = run.value("events.bounce");
  EXPECT_GT(bounces, 30);
  EXPECT_LT(bounces, 80);
  // Control: no restitution below one rests while the ball still flies.
  OdeRun lively(ball("1"), 0.001);
  lively.steps(10000);
  EXPECT_EQ(lively.value("events.bounce.resting"), 0);
  EXPECT_NEAR(0.5 * std::pow(lively.value("v"), 2) + 9.81 * lively.value("h"), 9.81, 1e-5);
}

TEST(OdeBouncesComeToRest, RidesAFloorThatMovesAndLeavesOneThatDrops) {
  // Amplitude 0.1 m: at 5 rad/s the floor's acceleration stays below g, at 15 rad/s it throws the ball.
  const auto on_floor = [](double omega) {
    return OdeRun(R"s("states": {"h": 0.2, "v": 0}, "parameters": {"w": )s" + write_number(omega) +
                      R"s(}, "equations": {"h": "v", "v": "-9.81"}, "events": [{"name": "bounce",
                      "when": "h - 0.1 * sin(w * t)", "direction": "falling",
                      "set": {"v": "0.1 * w * cos(w * t) - 0.3 * (v - 0.1 * w * cos(w * t))"}}])s",
                  0.01);
  };
  OdeRun slow = on_floor(5);
  double apart = 0;
  for (int k = 1; k <= 1000; ++k) {
    const double h = slow.steps(1).value("h");
    if (k > 500) apart = std::max(apart, std::abs(h - 0.1 * std::sin(5 * k * 0.01)));
  }
  EXPECT_LT(apart, 1e-6);
  OdeRun fast = on_floor(15);
  double below = 0, above = 0;
  for (int k = 1; k <= 1000; ++k) {
    const double gap = fast.steps(1).value("h") - 0.1 * std::sin(15 * k * 0.01);
    below = std::min(below, gap), above = std::max(above, gap);
  }
  EXPECT_GT(below, -1e-6);
  EXPECT_GT(above, 0.02);
}

TEST(OdeBouncesComeToRest, WhatMovesTheBallMovesItAgain) {
  OdeRun kicked(ball("0.5", "dopri5", R"s(, {"at": 5, "set": {"v": "3"}})s"), 0.01);
  kicked.steps(499);
  EXPECT_EQ(kicked.value("events.bounce.resting"), 1);
  kicked.steps(26);
  EXPECT_NEAR(kicked.value("h"), 3 * 0.25 - 0.5 * 9.81 * 0.0625, 1e-6);
  kicked.steps(500);
  EXPECT_EQ(kicked.value("events.bounce.resting"), 1);
  // A command lifts it; then gravity itself is reversed.
  kicked.set("h", 0.4);
  kicked.steps(1);
  EXPECT_NEAR(kicked.value("h"), 0.4 - 0.5 * 9.81 * 1e-4, 1e-7);
  kicked.steps(500);
  EXPECT_NEAR(kicked.value("h"), 0, 1e-8);
  kicked.set("g", -1);
  kicked.steps(100);
  EXPECT_NEAR(kicked.value("h"), 0.5, 1e-3);
}

TEST(OdeBouncesComeToRest, AStateThatBeginsInContactAndOneThatSlides) {
  OdeRun run(R"s("states": {"h": 0, "v": 0, "x": 0, "u": 2}, "equations": {"h": "v", "v": "-9.81", "x": "u",
    "u": "0"}, "events": [{"name": "bounce", "when": "h", "direction": "falling", "set": {"v": "-0.5 * v"}}])s");
  run.steps(50);
  EXPECT_EQ(run.value("h"), 0);
  EXPECT_NEAR(run.value("x"), 10, 1e-9);
  // Control: an event that reverses nothing is simply passed, once.
  OdeRun passed(R"s("states": {"h": 1, "v": 0, "n": 0}, "equations": {"h": "v", "v": "-9.81", "n": "0"},
    "events": [{"name": "gate", "when": "h", "direction": "falling", "set": {"n": "n + 1", "v": "0.5 * v"}}])s");
  passed.steps(20);
  EXPECT_EQ(passed.value("n"), 1);
  EXPECT_LT(passed.value("h"), -1);
}

TEST(OdeBouncesComeToRest, ASnapshotAtRestContinuesTheSameWay) {
  OdeRun run(ball("0.5", "dopri5", R"s(, {"at": 5, "set": {"v": "3"}})s"), 0.01);
  run.steps(400);
  WorldState copy = WorldState::deserialize(run.state.serialize());
  run.steps(300);
  Workspace workspace;
  ThreadArena arena(1);
  for (int k = 0; k < 300; ++k) run.world().step(copy, workspace, arena, {});
  EXPECT_EQ(copy, run.state);
}

}  // namespace
}  // namespace truestep::test
