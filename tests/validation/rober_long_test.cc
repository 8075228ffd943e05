// Robertson's reaction to 1e11 s in steps of 1e9 s: chemistry takes as long as it takes. Bodies do not.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/json.h"
#include "engine/session/describe.h"
#include "engine/session/world.h"

namespace truestep {
namespace {

TEST(LongReactions, RoberRunsTo1e11Seconds) {
  const World world(
      parse_scene(R"({"time": {"dt": 1e9, "duration": 1e11}, "systems": [{"type": "ode", "id": "r",
    "states": {"a": 1, "b": 0, "c": 0}, "equations": {"a": "-0.04 * a + 1e4 * b * c",
    "b": "0.04 * a - 1e4 * b * c - 3e7 * b * b", "c": "3e7 * b * b"}, "integrator": "radau5",
    "relative_tolerance": 1e-7, "absolute_tolerance": 1e-16}]})"));
  WorldState s = world.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  for (int k = 0; k < 100; ++k) world.step(s, workspace, arena, {});
  const Observables end = world.observe(s);
  // IVP test set (Mazzia, Magherini 2008), ROBER at t = 1e11.
  EXPECT_NEAR(*end.find("r.a") / 0.2083340149701255e-7, 1, 1e-5);
  EXPECT_NEAR(*end.find("r.b") / 0.8333360770334713e-13, 1, 1e-5);
  EXPECT_NEAR(*end.find("r.c"), 0.9999999791665050, 1e-12);
}

// In the end b = 4e-6 a and c = 1, so that a' = -4.8e-4 a^2 and a = 1 / (4.8e-4 t).
TEST(LongReactions, RoberEndsAsItsClosedFormAt1e13Seconds) {
  const World world(
      parse_scene(R"({"time": {"dt": 1e11, "duration": 1e13}, "systems": [{"type": "ode", "id": "r",
    "states": {"a": 1, "b": 0, "c": 0}, "equations": {"a": "-0.04 * a + 1e4 * b * c",
    "b": "0.04 * a - 1e4 * b * c - 3e7 * b * b", "c": "3e7 * b * b"}, "integrator": "radau5",
    "relative_tolerance": 1e-7, "absolute_tolerance": 1e-18}]})"));
  WorldState s = world.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  for (int k = 0; k < 50; ++k) world.step(s, workspace, arena, {});
  const double halfway = *world.observe(s).find("r.a");
  for (int k = 0; k < 50; ++k) world.step(s, workspace, arena, {});
  // 1e-7 a step of the logarithm of t, of which there are some thirty decades and a hundred steps.
  EXPECT_NEAR(*world.observe(s).find("r.a") * 4.8e-4 * 1e13, 1, 1e-4);
  // Control: halfway it is another number.
  EXPECT_GT(std::abs(halfway * 4.8e-4 * 1e13 - 1), 0.5);
}

TEST(LongReactions, OnlyEquationsTakeStepsOfAges) {
  const auto faults = [](const std::string& time, const std::string& system) {
    const auto report = validate_scene(
        parse_json(R"({"time": )" + time + R"(, "systems": [)" + system + "]}"), AdmissionLimits{});
    return report.at("errors").as_array().size();
  };
  const std::string decay = R"({"type": "ode", "states": {"y": 1}, "equations": {"y": "-1e-12 * y"}})";
  const std::string mass = R"({"type": "oscillator"})";
  EXPECT_EQ(faults(R"({"dt": 1e13, "duration": 1e13})", decay), 0u);
  EXPECT_EQ(faults(R"({"dt": 1.1e13})", decay), 1u);
  EXPECT_EQ(faults(R"({"dt": 1e-15, "duration": 1e-12})", decay), 0u);
  EXPECT_EQ(faults(R"({"dt": 11})", mass), 1u);
  EXPECT_EQ(faults(R"({"dt": 11, "substeps": 2})", mass), 0u);
}

}  // namespace
}  // namespace truestep
