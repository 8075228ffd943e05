// A body in water that has no room for it: the error says which and what to do.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

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

}  // namespace
}  // namespace truestep
