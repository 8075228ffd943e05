// A scene with its test: what is run, and what is told of it. Above all: a control that does not fail is a
// failure.
#include "engine/studies/check/scene_check.h"

#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/studies/check/merge_patch.h"

namespace truestep {
namespace {

/// A ball falls by g t^2 / 2 = 4.905 m in a second; `test` is the value of "test".
boost::json::value falling_ball(const std::string& test) {
  return parse_json(
      R"({"gravity": [0, -9.81, 0], "time": {"dt": "10 ms", "duration": 1}, "systems": [{"type": "rigid3d", "id": "a",
    "bodies": [{"type": "sphere", "radius": 0.1, "position": [0, 0, 0]}]}],
    "probes": [{"id": "ball", "system": "a", "index": 0}],
    "expect": [{"quantity": "ball.position.y", "equals": -4.905, "tolerance": 0.06, "source": "g t^2 / 2"}],
    "test": )" +
      test + "}");
}

std::vector<CheckFinding> findings(const std::string& test, size_t runs) {
  SceneCheck check(falling_ball(test));
  EXPECT_EQ(check.size(), runs) << test;
  for (size_t i = 0; i < check.size(); ++i) check.run(i);
  return check.findings();
}

TEST(SceneCheck, RunsEveryCombination) {
  EXPECT_TRUE(findings("{}", 1).empty());
  EXPECT_TRUE(findings(R"({"vary": {"precision": ["f32", "f64"], "dt": [0.01, 0.005, 0.02]}})", 6).empty());
  const auto missed = findings(R"({"vary": {"precision": ["f32", "f64"], "/gravity/1": [-9.81, -5]}})", 4);
  ASSERT_EQ(missed.size(), 2u);
  EXPECT_EQ(missed[0].variation, R"(precision = "f32", /gravity/1 = -5)");
  EXPECT_EQ(missed[0].quantity, "ball.position.y");
  EXPECT_NEAR(missed[0].measured.value(), -2.5, 0.05);
  EXPECT_EQ(missed[0].wanted, "equal to -4.905 +- 0.06");
}

TEST(SceneCheck, AControlMustFail) {
  EXPECT_TRUE(findings(R"({"control": [{"set": {"/gravity": [0, 0, 0]}, "fails": ["ball.position.y"]}]})", 2)
                  .empty());
  EXPECT_TRUE(findings(R"({"control": [{"set": {"/gravity": [0, 0, 0]}}]})", 2).empty());
  for (const char* useless :
       {R"({"set": {"/gravity/0": 1}, "fails": ["ball.position.y"]})", R"({"set": {"/gravity/0": 1}})",
        R"({"set": {"/gravity": "up"}, "fails": ["ball.position.y"]})", R"({"set": {"/gravity": "up"}})"}) {
    const auto found = findings(std::string(R"({"control": [)") + useless + "]}", 2);
    ASSERT_EQ(found.size(), 1u) << useless;
    EXPECT_EQ(found[0].quantity, "control") << useless;
  }
}

TEST(SceneCheck, ComparesBitsAndValues) {
  EXPECT_TRUE(
      findings(R"({"vary": {"threads": [1, 2], "resumed": [false, true], "scratch": ["kept", "dropped"]}})",
               8)
          .empty());
  EXPECT_THROW(findings(R"({"vary": {"scratch": ["some"]}})", 1), Error);
  const auto differ = findings(R"({"vary": {"dt": [0.01, 0.005]}, "same": ["dt"]})", 2);
  ASSERT_EQ(differ.size(), 1u);
  EXPECT_EQ(differ[0].quantity, "same");
  EXPECT_TRUE(
      findings(
          R"({"vary": {"dt": [0.01, 0.005]}, "agree": [{"quantity": "ball.position.y", "over": "dt", "tolerance": 0.1}]})",
          2)
          .empty());
  EXPECT_EQ(
      findings(
          R"({"vary": {"/gravity/1": [-9.81, -9.8]}, "agree": [{"quantity": "ball.position.y", "over": "/gravity/1", "tolerance": 1e-9}]})",
          2)
          .size(),
      1u);
}

// g t^2 / 2 grows with the square of the duration.
TEST(SceneCheck, QuantitiesGrowAsPowers) {
  const auto order = [](const char* n) {
    return findings(
               R"({"cases": [{"expect": [{"quantity": "ball.position.y", "max": 0}]}], "vary": {"/time/duration": [0.5, 1, 2]},
      "agree": [{"quantity": "ball.position.y", "over": "/time/duration", "tolerance": 0.05, "order": )" +
                   std::string(n) + "}]}",
               3)
        .size();
  };
  EXPECT_EQ(order("2"), 0u);
  EXPECT_EQ(order("1.8"), 2u);
}

TEST(SceneCheck, ScenesThatMustBeRefusedAndCases) {
  const std::string refused = R"({"cases": [{}, {"name": "no size", "set": {"/systems/0/bodies/0/radius": -1},
    "refused": {"code": "out_of_range", "pointer": "/systems/0/bodies/0/radius"}},
    {"set": {"/gravity": [0, 0, 0]}, "expect": [{"quantity": "ball.position.y", "equals": 0}]}]})";
  EXPECT_TRUE(findings(refused, 3).empty());
  EXPECT_EQ(findings(R"({"refused": {"code": "out_of_range"}})", 1).size(), 1u) << "it is accepted";
  EXPECT_EQ(findings(R"({"instability": "expected"})", 1).size(), 1u);
}

TEST(SceneCheck, FaultsAreThoseOfTheListAndNoOthers) {
  const auto faults = [](const std::string& list) {
    return findings(R"({"cases": [{"set": {"/gravty": 1, "/systems/0/bodies/0/radius": -1}, "faults": [)" +
                        list + "]}]}",
                    1)
        .size();
  };
  const std::string key = R"({"pointer": "/gravty", "did_you_mean": "gravity"})",
                    radius = R"({"pointer": "/systems/0/bodies/0/radius", "says": "-1"})";
  EXPECT_EQ(faults(radius + ", " + key), 0u);
  EXPECT_EQ(faults(key), 1u) << "there is another";
  EXPECT_EQ(faults(radius + ", " + key + ", {}"), 1u) << "there are but two";
  EXPECT_EQ(faults(key + R"(, {"says": "-2"})"), 1u);
}

TEST(SceneCheck, CommandsMayHaveToBeRefusedAndAreChangedAsTheScene) {
  const auto command = [](const std::string& members, const std::string& more = "", size_t runs = 1) {
    return findings(
        R"({"commands": [{"at_time": 0.5, "type": "impulse", "system": "a", "impulse": [0, 1000, 0], )" +
            members + "}]" + more + "}",
        runs);
  };
  EXPECT_TRUE(command(R"("index": 7, "refused": {"pointer": "/index"})").empty());
  for (const char* other : {R"("index": 7, "refused": {"pointer": "/type"})",
                            R"("index": 0, "refused": {"pointer": "/index"})"}) {
    const auto found = command(other);
    ASSERT_FALSE(found.empty()) << other;
    EXPECT_EQ(found[0].quantity, "commands") << other;
  }
  EXPECT_EQ(command(R"("index": 7)").at(0).quantity, "refused");
  const std::string varied = R"(, "vary": {"/test/commands/0/impulse/1": [0, 1000]})";
  EXPECT_EQ(command(R"("index": 0)", varied, 2).size(), 1u);
}

TEST(SceneCheck, StagesOfThePlanHaveTheirReasons) {
  boost::json::value scene = parse_json(
      R"({"time": {"dt": 0.01, "duration": 0.01}, "systems": [{"type": "oscillator", "id": "o", "stiffness": 100}]})");
  const auto reasons = [&](const char* plan) {
    scene.as_object()["test"] = parse_json(std::string(R"({"plan": {)") + plan + "}}");
    SceneCheck check(scene);
    check.run(0);
    return check.findings().size();
  };
  EXPECT_EQ(reasons(R"("integrate": "rk4", "o.integrate": "")"), 0u);
  EXPECT_EQ(reasons(R"("integrate": "bdf2")"), 1u);
  EXPECT_EQ(reasons(R"("p.integrate": "rk4")"), 1u);
}

TEST(SceneCheck, CarriesOutCommands) {
  const auto pushed = findings(
      R"({"commands": [{"at_time": 0.5, "type": "impulse", "system": "a", "index": 0, "impulse": [0, 1000, 0]}]})",
      1);
  ASSERT_EQ(pushed.size(), 1u);
  EXPECT_GT(pushed[0].measured.value(), 0);
}

TEST(SceneCheck, FaultsOfTheTestAreFaultsOfTheScene) {
  for (const char* test : {R"({"vary": {"speed": [1]}})", R"({"vary": {"dt": 1}})", R"({"contrl": []})", "3",
                           R"({"control": [{"set": {"gravity": 1}}]})", R"({"same": ["dt"]})",
                           R"({"control": [{"case": "none"}]})", R"({"commands": [{}]})"}) {
    EXPECT_THROW(SceneCheck{falling_ball(test)}, Error) << test;
    EXPECT_FALSE(read_scene(falling_ball(test)).scene.has_value()) << test;
  }
}

TEST(MergePatch, ReplacesAddsAndRemoves) {
  boost::json::value a = parse_json(R"({"a": {"b": 1, "c": [1, 2]}, "d": 2})");
  merge_patch(a, parse_json(R"({"a": {"b": null, "c": [3]}, "e": {"f": null, "g": 1}})"));
  EXPECT_EQ(a, parse_json(R"({"a": {"c": [3]}, "d": 2, "e": {"g": 1}})"));
}

}  // namespace
}  // namespace truestep
