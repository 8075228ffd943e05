// One-way platforms in the plane and in space: a ball thrown up passes and comes to rest on top, whatever
// passed may not be held half-way, and nothing falls through from above, however fast.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

const std::string kOneWayTypes[] = {"rigid2d", "rigid3d"};

/// A platform 4 m wide whose top is at y = 2, a floor at y = 0, and balls of 0.25 m.
struct OneWayTrial {
  OneWayTrial(const std::string& type, const std::string& platform, const std::vector<std::string>& balls)
      : world(parse_scene(text(type, platform, balls))), state(world.initial_state()) {}
  static std::string text(const std::string& type, const std::string& platform,
                          const std::vector<std::string>& balls) {
    const bool flat = type == "rigid2d";
    const auto shape = [&](const std::string& what) { return flat ? R"("shapes": [{)" + what + "}]" : what; };
    std::string list = R"({"motion": "fixed", "position": [0, -0.5, 0], )" +
                       shape(R"("type": "box", "half_extents": [20, 0.5, 20])") +
                       R"(}, {"motion": "fixed", "position": [0, 1.9, 0], )" + platform + ", " +
                       shape(R"("type": "box", "half_extents": [2, 0.1, 2])") + "}";
    for (const std::string& ball : balls) {
      list += ", {" + ball + ", " +
              shape(R"("type": ")" + std::string(flat ? "circle" : "sphere") + R"(", "radius": 0.25)") + "}";
    }
    return R"({"gravity": [0, -10, 0], "time": {"dt": 0.01}, "systems": [{"type": ")" + type +
           R"(", "id": "r", "bodies": [)" + list + "]}]}";
  }
  OneWayTrial& seconds(double s) {
    for (int k = 0; k < std::lround(s / 0.01); ++k) world.step(state, workspace, arena, {});
    return *this;
  }
  Vec3 ball(size_t k) {
    const State& s = state.systems[0];
    return load3<double>(s.f64(s.at("position")).data(), 2 + k);
  }
  double awake() const { return world.observe(state).find("r.awake").value(); }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

const std::string kUp = R"("one_way": [0, 2, 0])";

TEST(OneWay, ABallPassesFromBelowAndIsHeldFromAbove) {
  for (const std::string& type : kOneWayTypes) {
    // From y = 0.25 with 8 m/s up to 3.45.
    OneWayTrial t(type, kUp, {R"("position": [0, 0.25, 0], "velocity": [0, 8, 0])"});
    EXPECT_NEAR(t.seconds(0.8).ball(0).y, 0.25 + 8 * 0.8 - 5 * 0.8 * 0.8, 0.03) << type << ": not slowed";
    EXPECT_NEAR(t.seconds(3).ball(0).y, 2.25, 1e-3) << type;
    EXPECT_EQ(t.awake(), 0) << type;
    OneWayTrial solid(type, R"("density": 1000)", {R"("position": [0, 0.25, 0], "velocity": [0, 8, 0])"});
    EXPECT_NEAR(solid.seconds(3.8).ball(0).y, 0.25, 1e-3) << type << ": the control";
  }
}

TEST(OneWay, ABallThatTurnsBackInsideFallsOut) {
  for (const std::string& type : kOneWayTypes) {
    // Up to 1.85: its top is 10 cm above the platform's.
    const double v = std::sqrt(2 * 10 * (1.85 - 0.25));
    OneWayTrial t(type, kUp, {R"("position": [0, 0.25, 0], "velocity": [0, )" + std::to_string(v) + ", 0]"});
    EXPECT_NEAR(t.seconds(v / 10).ball(0).y, 1.85, 0.05) << type;
    EXPECT_NEAR(t.seconds(3).ball(0).y, 0.25, 1e-3) << type;
  }
}

TEST(OneWay, ItsDirectionTurnsWithIt) {
  for (const std::string& type : kOneWayTypes) {
    const std::string axis = type == "rigid2d" ? "" : R"("axis": [0, 0, 1], )";
    OneWayTrial t(type, axis + R"("angle": 3.141592653589793, "one_way": [0, -1, 0])",
                  {R"("position": [0, 0.25, 0], "velocity": [0, 8, 0])"});
    EXPECT_NEAR(t.seconds(3.8).ball(0).y, 2.25, 1e-3) << type;
    // Down: what lies above it falls through.
    OneWayTrial down(type, R"("one_way": [0, -1, 0])", {R"("position": [0, 3, 0])"});
    EXPECT_NEAR(down.seconds(3).ball(0).y, 0.25, 1e-3) << type;
  }
}

TEST(OneWay, ItHoldsWhatIsFastFromAboveAndLetsItPassFromBelow) {
  for (const std::string& type : kOneWayTypes) {
    // 2 to 5 m per step through 20 cm.
    for (const double v : {200.0, 337.0, 500.0}) {
      OneWayTrial t(type, kUp,
                    {R"("position": [0, 10, 0], "velocity": [0, )" + std::to_string(-v) + ", 0]",
                     R"("position": [1, 0.25, 0], "velocity": [0, )" + std::to_string(v) + ", 0]"});
      t.seconds(0.2);
      EXPECT_GT(t.ball(0).y, 2) << type << v;
      EXPECT_GT(t.ball(1).y, 10) << type << v;
    }
  }
}

TEST(OneWay, TheDirectionMustNotBeZero) {
  for (const std::string& type : kOneWayTypes) {
    EXPECT_THROW(OneWayTrial(type, R"("one_way": [0, 0, 0])", {R"("position": [0, 3, 0])"}), Error) << type;
  }
}

}  // namespace
}  // namespace truestep
