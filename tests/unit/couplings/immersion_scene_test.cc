// A body in water that has no room for it: the error says which and what to do.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

std::vector<Issue> faults() {
  try {
    const World world(parse_scene(R"({"systems": [
      {"type": "rigid3d", "id": "crates", "bodies": [
        {"type": "box", "motion": "fixed", "half_extents": [1, 0.1, 1], "position": [0, -0.1, 0]},
        {"type": "box", "half_extents": [0.1, 0.1, 0.1], "position": [0.3, 0.3, 0.3]}]},
      {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.6, 0.6, 0.6], "spacing": 0.05,
       "bodies": [{"center": [0.3, 0.15, 0.3], "half_extents": [0.3, 0.15, 0.3]}]}],
      "couplings": [{"type": "immersion", "a": "crates", "b": "water"}]})"));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "scene_invalid");
    return e.issues();
  }
  return {};
}

// The 32 particles of the crate's lower half; a fixed body is not in the water unless the scene says so.
TEST(ImmersionScene, WaterInABodyIsToldTheWayOut) {
  const auto issues = faults();
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].pointer, "/couplings/0/b");
  EXPECT_NE(issues[0].message.find("of its particles inside body 1"), std::string::npos) << issues[0].message;
  EXPECT_NE(issues[0].allowed.find("hollows"), std::string::npos) << issues[0].allowed;
}

double height(const testing_coupled::SceneRun& run, size_t row) {
  return ConstBodies(run.session.state().systems[0], *run.world->system(0).ports().bodies).place(row).y;
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
  run.session.step(7);
  const double first = height(run, 1);
  run.session.step(1);
  const double second = height(run, 1);
  EXPECT_GT(testing_coupled::body_velocity(run).y, -1.9) << "control: the first ball has met the water";
  Command remove;
  remove.kind = CommandKind::remove, remove.system = "balls", remove.index = 0;
  run.session.command(remove);
  EXPECT_NEAR(testing_coupled::body_velocity(run).y, -9.81 * 0.08, 1e-9);
  run.session.step(1);
  EXPECT_NEAR(testing_coupled::body_velocity(run).y, -9.81 * 0.09, 1e-9);
  EXPECT_NEAR(height(run, 0) - second, second - first - 9.81 * 1e-4, 1e-9)
      << "the way of a step of free fall";
}

}  // namespace
}  // namespace truestep
