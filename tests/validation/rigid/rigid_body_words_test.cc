// Bodies take the same words in the plane and in space and do the same by them: group, asleep, can_sleep.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/support/world_run.h"

namespace truestep {
namespace {

const std::string kTypes[] = {"rigid2d", "rigid3d"};

/// Boxes of 1 m on a floor whose top is at y = 0; each is given by its height and its other members.
struct Boxes : testing_rig::WorldRun {
  Boxes(const std::string& type, const std::vector<std::pair<double, std::string>>& boxes,
        const std::string& floor = "", const std::string& system = "")
      : WorldRun(scene(type, boxes, floor, system)) {}
  static std::string scene(const std::string& type, const std::vector<std::pair<double, std::string>>& boxes,
                           const std::string& floor, const std::string& system) {
    const bool flat = type == "rigid2d";
    const auto box = [&](double half, double y, const std::string& more) {
      const std::string h = std::to_string(half);
      const std::string size = R"("type": "box", "half_extents": [)" + h + ", 0.5, " + (flat ? "0" : h) + "]";
      return R"({"position": [0, )" + std::to_string(y) + ", 0], " +
             (flat ? R"("shapes": [{)" + size + "}]" : size) + more + "}";
    };
    std::string list = box(5, -0.5, R"(, "motion": "fixed")" + floor);
    for (const auto& [y, more] : boxes) list += ", " + box(0.5, y, more);
    return R"({"gravity": [0, -10, 0], "time": {"dt": 0.01}, "systems": [{"type": ")" + type +
           R"(", "id": "r", "bodies": [)" + list + "]" + system + "}]}";
  }
  double height(size_t box) const { return vec("position", box + 1).y; }
  double awake() const { return observed("awake"); }
};

TEST(RigidBodyWords, VelocitiesAreSetWhileTheSceneRuns) {
  for (const std::string& type : kTypes) {
    Boxes boxes(type, {{0.5, ""}});
    boxes.seconds(3);
    EXPECT_EQ(boxes.awake(), 0) << type;
    Command c;
    c.kind = CommandKind::set_parameter, c.index = 1, c.name = "velocity", c.vector = {0, 5, 0};
    boxes.apply(c);
    c.name = "angular_velocity", c.value = -2, c.vector = {0, 0, -2};
    boxes.apply(c);
    EXPECT_EQ(boxes.awake(), 1) << type;
    boxes.seconds(0.4);
    EXPECT_NEAR(boxes.height(0), 0.5 + 5 * 0.4 - 5 * 0.4 * 0.4, 0.03) << type;
    c.index = 0;
    EXPECT_THROW(boxes.apply(c), Error) << type << ": fixed";
  }
}

}  // namespace
}  // namespace truestep
