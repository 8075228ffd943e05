// Robertson's reaction to 1e11 s in steps of 1e9 s: chemistry may take arbitrarily long, unlike the motion of
// bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/json/json.h"
#include "engine/session/describe.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

/// The reaction in a hundred steps of dt (s).
class Rober {
 public:
  Rober(const std::string& dt, const std::string& absolute)
      : world_(parse_scene(R"({"time": {"dt": )" + dt + R"(}, "systems": [{"type": "ode", "id": "r",
    "states": {"a": 1, "b": 0, "c": 0}, "equations": {"a": "-0.04 * a + 1e4 * b * c",
    "b": "0.04 * a - 1e4 * b * c - 3e7 * b * b", "c": "3e7 * b * b"}, "integrator": "radau5",
    "relative_tolerance": 1e-7, "absolute_tolerance": )" +
                           absolute + "}]}")),
        state_(world_.initial_state()) {}
  Rober& steps(int n) {
    for (int k = 0; k < n; ++k) world_.step(state_, workspace_, arena_, {});
    return *this;
  }
  double operator[](const char* name) const { return world_.observe(state_).find(name).value(); }

 private:
  World world_;
  WorldState state_;
  Workspace workspace_;
  ThreadArena arena_{1};
};

TEST(LongReactions, RoberRunsTo1e11Seconds) {
  Rober end("1e9", "1e-16");
  end.steps(100);
  // IVP test set (Mazzia, Magherini 2008), ROBER at t = 1e11.
  EXPECT_NEAR(end["r.a"] / 0.2083340149701255e-7, 1, 1e-5);
  EXPECT_NEAR(end["r.b"] / 0.8333360770334713e-13, 1, 1e-5);
  EXPECT_NEAR(end["r.c"], 0.9999999791665050, 1e-12);
}

// In the end b = 4e-6 a and c = 1, so that a' = -4.8e-4 a^2 and a = 1 / (4.8e-4 t).
TEST(LongReactions, RoberEndsAsItsClosedFormAt1e13Seconds) {
  Rober run("1e11", "1e-18");
  const double halfway = run.steps(50)["r.a"];
  // 1e-7 per step of the logarithm of t; there are some thirty decades and a hundred steps.
  EXPECT_NEAR(run.steps(50)["r.a"] * 4.8e-4 * 1e13, 1, 1e-4);
  // Control: halfway the value is different.
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
