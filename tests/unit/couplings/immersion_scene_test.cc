// What a scene must not contain about bodies in water, and where the error is reported.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

std::vector<Issue> faults(const std::string& hollows, const std::string& coupling) {
  try {
    const World world(parse_scene(R"({"systems": [
      {"type": "rigid3d", "id": "crates", "bodies": [
        {"type": "box", "motion": "fixed", "half_extents": [1, 0.1, 1], "position": [0, -0.1, 0]},
        {"type": "box", "half_extents": [0.1, 0.1, 0.1], "position": [0.3, 0.3, 0.3]}]},
      {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.6, 0.6, 0.6], "spacing": 0.05,
       "bodies": [{"center": [0.3, 0.15, 0.3], "half_extents": [0.3, 0.15, 0.3]}])" +
                                  hollows + R"(},
      {"type": "sph", "id": "sheet", "dimension": 2, "bodies": [{"center": [0.5, 0.3, 0]}]},
      {"type": "pendulum", "id": "clock"}], "couplings": [)" +
                                  coupling + "]}"));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "scene_invalid");
    return e.issues();
  }
  return {};
}

TEST(ImmersionScene, EveryFaultHasItsPointer) {
  const std::string hollow = R"(, "hollows": [{"center": [0.3, 0.3, 0.3]}])";
  struct Case {
    const char* coupling;
    const char* pointer;
    const char* code;
  };
  for (const Case& c : {
           Case{R"({"type": "immersion", "a": "clock", "b": "water"})", "/couplings/0/a",
                "unsuitable_system"},
           Case{R"({"type": "immersion", "a": "water", "b": "crates"})", "/couplings/0/a",
                "unsuitable_system"},
           Case{R"({"type": "immersion", "a": "crates", "b": "clock"})", "/couplings/0/b",
                "unsuitable_system"},
           Case{R"({"type": "immersion", "a": "crates", "b": "sheet"})", "/couplings/0/b",
                "unsuitable_system"},
           Case{R"({"type": "immersion", "a": "crates", "b": "water", "bodies": "some"})",
                "/couplings/0/bodies", "unknown_choice"},
       }) {
    const auto issues = faults(hollow, c.coupling);
    ASSERT_EQ(issues.size(), 1u) << c.coupling;
    EXPECT_EQ(issues[0].pointer, c.pointer) << c.coupling;
    EXPECT_EQ(issues[0].code, c.code) << c.coupling;
  }
  EXPECT_TRUE(faults(hollow, R"({"type": "immersion", "a": "crates", "b": "water"})").empty());
}

// The 32 particles of the crate's lower half; a fixed body is not in the water unless the scene says so.
TEST(ImmersionScene, WaterInABodyIsToldTheWayOut) {
  const auto issues = faults("", R"({"type": "immersion", "a": "crates", "b": "water"})");
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].pointer, "/couplings/0/b");
  EXPECT_NE(issues[0].message.find("of its particles inside body 1"), std::string::npos) << issues[0].message;
  EXPECT_NE(issues[0].allowed.find("hollows"), std::string::npos) << issues[0].allowed;
}

TEST(ImmersionScene, HollowsAreLeftOut) {
  const auto particles = [](const std::string& hollows) {
    const World world(parse_scene(R"({"systems": [{"type": "sph", "low": [0, 0, 0], "high": [1, 1, 1],
      "spacing": 0.1, "bodies": [{"center": [0.5, 0.5, 0.5], "half_extents": [0.5, 0.5, 0.5]}])" +
                                  hollows + "}]}"));
    return world.initial_state().systems[0].rows(0);
  };
  EXPECT_EQ(particles(""), 1000u);
  EXPECT_EQ(particles(R"(, "hollows": [{"center": [0.5, 0.5, 0.5], "half_extents": [0.2, 0.1, 0.3]}])"),
            1000u - 4 * 2 * 6);
  EXPECT_EQ(particles(R"(, "hollows": [{"shape": "ball", "center": [0, 0, 0], "radius": 0.1}])"), 999u);
}

// What the water did to a body is its own: the one that takes its row falls as if nothing had been.
TEST(ImmersionScene, ABodyThatTakesARowTakesNoImpulse) {
  testing_coupled::SceneRun run(R"({"time": {"dt": 0.01}, "systems": [
    {"type": "rigid3d", "id": "balls", "bodies": [
      {"type": "sphere", "radius": 0.06, "density": 300, "position": [0.15, 0.2, 0.15], "velocity": [0, -2, 0]},
      {"type": "sphere", "radius": 0.06, "position": [0.15, 2, 0.15]}]},
    {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.3, 0.6, 0.3], "spacing": 0.03,
     "bodies": [{"center": [0.15, 0.06, 0.15], "half_extents": [0.15, 0.06, 0.15]}]}],
    "couplings": [{"type": "immersion", "a": "balls", "b": "water"}]})");
  run.session.step(8);
  EXPECT_GT(testing_coupled::body_velocity(run).y, -1.9) << "control: the first ball has met the water";
  Command remove;
  remove.kind = CommandKind::remove, remove.system = "balls", remove.index = 0;
  run.session.command(remove);
  const double before = testing_coupled::body_velocity(run).y;
  EXPECT_NEAR(before, -9.81 * 0.08, 1e-9);
  run.session.step(1);
  EXPECT_NEAR(testing_coupled::body_velocity(run).y, before - 9.81 * 0.01, 1e-9);
}

}  // namespace
}  // namespace truestep
