// Pictures of several systems: one range for the colours that one bar explains, names where colours tell no
// systems apart, and what is up.
#include <gtest/gtest.h>

#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"

namespace truestep {
namespace {

// Points at 1 and 2 m/s, and `second`.
std::string two_of(const std::string& second, const std::string& viewer) {
  return R"({"schema_version": "1.0", "name": "two", "time": {"dt": 0.01}, "gravity": [0, 0, 0],
    "viewer": {)" +
         viewer + R"(}, "systems": [
    {"type": "nbody", "id": "slow_ones", "positions": [[0, 0, 0], [0, 1, 0]], "velocities": [[1, 0, 0], [2, 0, 0]],
     "masses": [0, 0], "radius": 0.1})" +
         second + "]}";
}
constexpr const char* kFast = R"(,
    {"type": "nbody", "id": "fast", "positions": [[5, 2, 0]], "velocities": [[3, 0, 0]], "masses": [0], "radius": 0.1})";

DrawList pictured(const std::string& scene) {
  const Session session(std::make_shared<const World>(parse_scene(scene)),
                        std::make_shared<const ThreadArena>(1));
  return draw_list_of(session.world(), *session.frame_of(session.state(), picture_request(session.world())));
}

TEST(PictureOfSystems, OneBarExplainsTheColoursOfAll) {
  const DrawList list = pictured(two_of(kFast, R"("color_by": "speed")"));
  ASSERT_EQ(list.points.size(), 2u);
  for (const DrawPoints& set : list.points) {
    EXPECT_EQ(set.scalar_min, 1.0f);
    EXPECT_EQ(set.scalar_max, 3.0f);
  }
  // Controls: a range of the scene stays, and one system has its own.
  EXPECT_EQ(pictured(two_of(kFast, R"("color_by": "speed", "range": [0, 9])")).points[0].scalar_max, 9.0f);
  EXPECT_FALSE(pictured(two_of("", R"("color_by": "speed")")).points[0].scalar_max);
}

TEST(PictureOfSystems, ColouredSystemsAreNamed) {
  const DrawList list = pictured(two_of(kFast, R"("color_by": "speed")"));
  ASSERT_EQ(list.labels.size(), 2u);
  EXPECT_EQ(list.labels[0].text, "slow ones");
  EXPECT_EQ(list.labels[0].at.y, 1);  // over the middle of both, as high as the higher
  EXPECT_EQ(list.labels[1].text, "fast");
  // A system alone needs no name, and colours of their own have a legend.
  EXPECT_TRUE(pictured(two_of("", R"("color_by": "speed")")).labels.empty());
  EXPECT_TRUE(pictured(two_of(kFast, "")).labels.empty());
  EXPECT_TRUE(pictured(two_of(kFast, R"("color_by": "speed", "labels": false)")).labels.empty());
}

TEST(PictureOfSystems, UpIsWhatTheScenesCameraNames) {
  const std::string at = R"("camera": {"eye": [3, -3, 3], "target": [0, 0, 0])";
  EXPECT_EQ(pictured(two_of("", at + R"(, "up": [0, 0, 1]})")).up.z, 1);
  EXPECT_EQ(pictured(two_of("", at + "}")).up.y, 1);
}

}  // namespace
}  // namespace truestep
