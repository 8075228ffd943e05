// The choice of a method for a given accuracy: it is cheap, it works for every kind of system that takes a
// method, and its reasons for a refusal are true.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/studies/precision/accuracy.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"
#include "tests/support/patience.h"

namespace truestep {
namespace {

namespace json = boost::json;

json::value scene_of(const std::string& system, double tolerance, const std::string& quantity = "position",
                     double duration = 5) {
  json::value d =
      parse_json(R"({"schema_version": "1.0", "time": {"dt": 0.01}, "systems": [)" + system + "]}");
  d.as_object()["time"].as_object()["duration"] = duration;
  d.as_object()["accuracy"] = json::object{{"tolerance", tolerance}, {"quantity", quantity}};
  return d;
}

struct Plan : ::testing::Test {
  AccuracyOutcome choose(const json::value& d, double budget = 2) {
    runs = 0;
    return choose_method(d, budget, context);
  }
  ThreadArena arena{1};
  std::atomic<bool> cancelled{false};
  int runs = 0;  // scenes built by the last choice
  StudyContext context{.arena = arena,
                       .cancelled = cancelled,
                       .progress = [](double, const std::string&) {},
                       .admit = [this](const Cost&) { ++runs; }};
};

constexpr const char* kLotka = R"json({"type": "ode", "id": "s", "states": {"a": 1, "b": 0.5},
  "equations": {"a": "a * (1 - b)", "b": "b * (a - 1)"}})json";
constexpr const char* kDecay = R"json({"type": "ode", "id": "s", "states": {"a": 1},
  "equations": {"a": "-a + sin(t)"}})json";
constexpr const char* kVanDerPol = R"json({"type": "ode", "id": "s", "states": {"x": 2, "v": 0},
  "equations": {"x": "v", "v": "1000 * (1 - x^2) * v - x"}})json";
constexpr const char* kOscillator =
    R"json({"type": "oscillator", "id": "o", "mass": 1, "stiffness": 100, "damping": 2, "position": 1})json";
constexpr const char* kPendulum = R"json({"type": "pendulum", "id": "p", "links": 2, "angle": 0.5})json";
constexpr const char* kLinkage = R"json({"type": "articulation", "id": "l", "links": [
  {"id": "crank", "parent": "ground", "mass": 1, "center": [0.15, 0, 0], "q": [1], "v": [3]},
  {"id": "coupler", "parent": "crank", "offset": [0.3, 0, 0], "mass": 1, "center": [0.5, 0, 0], "q": [-0.6]},
  {"id": "rocker", "parent": "ground", "offset": [1, 0, 0], "mass": 1, "center": [0.4, 0, 0], "q": [1.3]}],
  "closures": [{"a": "coupler", "b": "rocker", "point_a": [1, 0, 0], "point_b": [0.8, 0, 0]}]})json";

// How many runs a choice starts does not depend on the clock, which only ends it sooner. Three runs to look,
// at most twelve for the reference (two methods, each tightened five times at most, and those that do not
// serve the system), and four settings of each of six methods.
TEST_F(Plan, IsMadeForEveryKindOfSystemFromAFewRuns) {
  constexpr int kMost = 3 + 12 + 4 * 6;
  for (const char* system : {kLotka, kDecay, kVanDerPol, kPendulum, kLinkage}) {
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      const json::value d = scene_of(system, tolerance, "position", system == kLinkage ? 1 : 5);
      AccuracyOutcome out = choose(d);
      // A processor taken away in the middle of a measurement ends it: that may last as long as the machine
      // has other work.
      for (const auto begun = std::chrono::steady_clock::now();
           out.report.at("judged_by") == "order" &&
           std::chrono::steady_clock::now() < begun + patience(60);) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        out = choose(d);
      }
      EXPECT_TRUE(out.report.contains("chosen")) << system << tolerance;
      EXPECT_NE(out.report.at("judged_by"), "order") << system << tolerance << "was not measured";
      EXPECT_LE(runs, kMost) << system << tolerance;
      // The control: without time, nothing is measured.
      EXPECT_EQ(choose(d, 0).report.at("judged_by"), "order") << system << tolerance;
    }
  }
}

// Of a long scene only a part is measured: a search costs some 24 runs of that part and at most ten of the
// whole.
TEST_F(Plan, OfALongSceneIsMadeFromAPart) {
  const AccuracyOutcome out = choose(scene_of(kLotka, 1e-6, "position", 1000));
  ASSERT_TRUE(out.report.contains("measured_horizon"));
  EXPECT_LT(out.report.at("measured_horizon").as_double(), 1000 * 0.5);
  // The control: eight steps are always measured whole.
  EXPECT_FALSE(choose(scene_of(kLotka, 1e-6, "position", 0.08)).report.contains("measured_horizon"));
}

TEST_F(Plan, AnEquationWithoutAPlotIsAsAccurateAsWasAsked) {
  const AccuracyOutcome out = choose(scene_of(kDecay, 1e-6));
  const auto end = [&](json::value d, const char* method, double tolerance) {
    d.as_object().erase("accuracy");
    if (method) set_integrator(d, 0, method), set_tolerance(d, 0, tolerance);
    return trace(build_world(d, context), {.field = {0, "state"}, .samples = 500}, context).values.back();
  };
  const auto exact = end(out.scene, "dop853", 1e-12);
  EXPECT_LT(relative_error(end(out.scene, nullptr, 0), exact), 1e-6);
  EXPECT_GT(relative_error(end(out.scene, "euler", 1), exact), 1e-6) << "control";
}

// Two runs of a ball at rest were said to differ by all of their height of 1e-20 m.
TEST_F(Plan, ABallThatHasComeToRestIsJudgedByItsFall) {
  constexpr const char* kBall = R"json({"type": "ode", "id": "s", "states": {"y": 1, "v": 0},
    "equations": {"y": "v", "v": "-9.81"},
    "events": [{"name": "hit", "when": "y", "direction": "falling", "set": {"v": "-0.8*v"}}]})json";
  for (const double tolerance : {1e-4, 1e-8})
    EXPECT_TRUE(choose(scene_of(kBall, tolerance, "state", 10)).report.contains("chosen")) << tolerance;
  // The control: what is larger than rounding counts in full.
  const std::vector<std::vector<double>> path{{1, -9}, {1e-5, 0}, {1e-16, 0}};
  EXPECT_NEAR(relative_error({1.1e-5, 0}, path[1], rounding_size(path)), 0.1, 1e-9);
  EXPECT_EQ(relative_error({2e-16, 0}, path[2], rounding_size(path)), 0);
}

TEST_F(Plan, WhatCannotBeReachedIsRefusedWithWhatCan) {
  const json::value d = scene_of(kOscillator, 1e-14, "position", 2);
  try {
    choose(d);
    FAIL() << "1e-14 over 200 steps is below rounding";
  } catch (const Error& e) {
    const Issue& issue = e.issues().at(0);
    EXPECT_EQ(e.code(), "accuracy_unreachable");
    ASSERT_TRUE(issue.allowed.starts_with("at least ")) << issue.allowed;
    EXPECT_GT(std::stod(issue.allowed.substr(9)), 1e-14) << "what is allowed is more than what was asked";
    EXPECT_EQ(std::string(e.what()).find("nothing"), std::string::npos);
  }
}

// Equations have no energy to be judged by where two accurate runs diverge: all methods used to be reported
// as failing.
TEST_F(Plan, EquationsThatPartAreRefusedForTheRightReason) {
  constexpr const char* kFast = R"json({"type": "ode", "id": "s", "states": {"u": 1, "v": 0},
    "equations": {"u": "v", "v": "-1e6 * u"}})json";
  const auto refusal = [&](const char* system, double tolerance, double duration) {
    try {
      choose(scene_of(system, tolerance, "position", duration));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), "accuracy_unreachable");
      return std::string(e.what()) + "; allowed: " + e.issues().at(0).allowed;
    }
    return std::string();
  };
  // 160 periods in doubles: rounding alone is some 1e-13 of each of a thousand radians.
  const std::string fast = refusal(kFast, 1e-13, 1);
  EXPECT_NE(fast.find(" differ by "), std::string::npos) << fast;
  EXPECT_NE(fast.find("allowed: at least "), std::string::npos) << fast;
  // The control: where the runs diverge by less than is asked for, there is a method.
  EXPECT_EQ(refusal(kFast, 1e-6, 1), "");
}

TEST_F(Plan, NamesAFieldThatThereIs) {
  try {
    choose(scene_of(kLotka, 1e-6, "temperature"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.issues().at(0).pointer, "/accuracy/quantity");
    EXPECT_NE(e.issues().at(0).allowed.find("state"), std::string::npos);
  }
}

}  // namespace
}  // namespace truestep
