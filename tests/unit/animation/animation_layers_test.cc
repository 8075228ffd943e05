// Layered motions: the effect of a layer's weight on known rotations.
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

/// One joint that rotates about z from `from` to `to` (degrees) in a second.
std::string file(double from, double to) {
  return R"({"bvh": ["HIERARCHY", "ROOT r", "{", "OFFSET 0 0 0", "CHANNELS 3 Zrotation Xrotation Yrotation", "JOINT a", "{",
     "OFFSET 0 0 0", "CHANNELS 3 Zrotation Xrotation Yrotation", "JOINT b", "{", "OFFSET 1 0 0", "CHANNELS 1 Zrotation",
     "End Site", "{", "OFFSET 1 0 0", "}", "}", "}", "}", "MOTION", "Frames: 2", "Frame Time: 1", "0 0 0 )" +
         std::to_string(from) + R"( 0 0 0", "0 0 0 )" + std::to_string(to) + R"( 0 0 0"]})";
}
/// Degrees of joint a at half a second, from the position of its child, 1 m along x.
double angle(const std::string& layers) {
  testing_coupled::SceneRun run(R"({"time": {"dt": 0.1}, "systems": [{"type": "motion_capture", "id": "s",
     "controls": [{"name": "w", "value": "0.25"}], "motion": )" +
                                file(10, 30) + layers + "}]}");
  run.session.step(5);
  return std::atan2(run.observe("s.joint.b.y"), run.observe("s.joint.b.x")) * 57.29577951308232;
}

TEST(Layers, CrossFadeGoesAShareOfTheWay) {
  EXPECT_NEAR(angle(""), 20, 1e-9);
  const std::string to = file(50, 70);  // 60 at half a second
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "0", "motion": )" + to + "}]"), 20, 1e-9);
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "w", "motion": )" + to + "}]"), 30, 1e-9);
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "1", "motion": )" + to + "}]"), 60, 1e-9);
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "7", "motion": )" + to + "}]"), 60, 1e-9)
      << "at most all of it";
}

TEST(Layers, AdditiveAddsTheWayFromTheFirstFrame) {
  const std::string way = file(50, 90);  // 20 degrees on after half a second
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "1", "mode": "additive", "motion": )" + way + "}]"), 40, 1e-9);
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "0.5", "mode": "additive", "motion": )" + way + "}]"), 30,
              1e-9);
  // Two layers, in their order.
  EXPECT_NEAR(angle(R"(, "layers": [{"weight": "1", "mode": "additive", "motion": )" + way +
                    R"(}, {"weight": "0.5", "motion": )" + file(0, 0) + "}]"),
              20, 1e-9);
}

}  // namespace
}  // namespace truestep
