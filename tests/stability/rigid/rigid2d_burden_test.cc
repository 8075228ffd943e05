// The number of substeps in the plane adapts to the load: towers that buckle with four of them, and heavy
// bodies on light ones.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rigid2d_run.h"

namespace truestep::testing {
namespace {

std::string tower(int boxes, const std::string& settings) {
  std::string scene = settings + R"("sleeping": false, "bodies": [
    {"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [20, 1, 0]}]})";
  for (int i = 0; i < boxes; ++i) {
    scene += R"(, {"position": [0, )" + FlatTrial::number(0.5 + i) +
             R"(, 0], "mass": 1, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]})";
  }
  return scene + "]";
}

TEST(Rigid2dBurden, ATowerOfFiftyStandsForAMinute) {
  for (const char* precision : {R"("precision": "f32", )", R"("precision": "f64", )"}) {
    FlatTrial t(tower(50, precision));
    t.steps(60 * 60);
    EXPECT_LT(std::abs(t.position(50).x), 1e-3) << precision;
    EXPECT_NEAR(t.position(50).y, 49.5, 1e-2) << precision;
  }
  // The control: contacts of a fixed frequency do not get stiffer with more substeps.
  FlatTrial soft(tower(50, R"("contact_hertz": 50, )"));
  soft.steps(60 * 60);
  EXPECT_GT(std::abs(soft.position(50).x), 0.1);
}

std::string pressed(const std::string& settings) {
  return settings + R"("sleeping": false, "bodies": [
    {"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [20, 1, 0]}]},
    {"position": [0, 0.25, 0], "mass": 20, "shapes": [{"type": "box", "half_extents": [0.25, 0.25, 0]}]},
    {"position": [0, 0.75, 0], "mass": 20, "shapes": [{"type": "box", "half_extents": [0.25, 0.25, 0]}]},
    {"position": [0, 2, 0], "mass": 2000, "shapes": [{"type": "box", "half_extents": [0.4, 0.4, 0]}]}])";
}

// Two tonnes fall 0.6 m on two boxes of 20 kg.
TEST(Rigid2dBurden, WhatIsHeavyRestsOnWhatIsLight) {
  for (const char* precision : {R"("precision": "f32", )", R"("precision": "f64", )"}) {
    FlatTrial t(pressed(precision));
    t.steps(60);
    EXPECT_LT(t.observed("penetration"), 0.01) << precision;
    EXPECT_GT(t.position(3).y, 1.38) << precision << ": a hundredth of a box's width deep at most";
  }
  // The control: six substeps, the largest number that 1 may become, are too few.
  FlatTrial few(pressed(R"("substeps": 1, )"));
  few.steps(60);
  EXPECT_GT(few.observed("penetration"), 0.02);
}

// A drum on its axle is heavy, but nothing carries it: the boxes that it turns over need no more substeps.
TEST(Rigid2dBurden, ADrumOnItsAxleIsNoBurden) {
  const auto most_substeps = [](const char* joints) {
    std::string scene = R"("sleeping": false, "bodies": [{"position": [0, 10, 0], "shapes": [
      {"type": "box", "half_extents": [0.2, 4, 0], "center": [4, 0, 0]}, {"type": "box", "half_extents": [0.2, 4, 0], "center": [-4, 0, 0]},
      {"type": "box", "half_extents": [4, 0.2, 0], "center": [0, 4, 0]}, {"type": "box", "half_extents": [4, 0.2, 0], "center": [0, -4, 0]}]})";
    for (int i = 0; i < 64; ++i) {
      scene += R"(, {"position": [)" + FlatTrial::number(-2 + 0.5 * (i % 8)) + "," +
               FlatTrial::number(8 + 0.5 * (i / 8)) +
               R"(, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]})";
    }
    // Next to it, a floor and two light boxes for a drum that falls on them.
    scene +=
        R"(, {"motion": "fixed", "position": [0, 0, 0], "shapes": [{"type": "box", "half_extents": [20, 1, 0]}]},
      {"position": [-3, 1.2, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
      {"position": [3, 1.2, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]})";
    FlatTrial t(scene + "]" + joints);
    uint32_t most = 0;
    for (int k = 0; k < 240; ++k) {
      t.steps(1);
      most = std::max(most, t.s().span<uint32_t>(t.s().at("small_steps"))[0]);
    }
    return most;
  };
  EXPECT_EQ(most_substeps(R"(, "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 10, 0],
                                 "motor_speed": 0.5, "max_motor": 1e8}])"),
            4u);
  EXPECT_GT(most_substeps(""), 8u) << "control: the drum falls on two boxes";
}

// A pendulum of 1 degree turns back slowly, but it does not rest.
TEST(Rigid2dSleep, WhatTurnsBackStaysAwake) {
  for (const double degrees : {0.3, 0.7, 1.0}) {
    const double a = degrees * 3.14159265 / 180;
    FlatTrial t(R"("bodies": [{"position": [)" + FlatTrial::number(1.6 * std::sin(a)) + "," +
                FlatTrial::number(-1.6 * std::cos(a)) +
                R"(, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.2}]}],
                "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0]}])");
    t.steps(10 * 60);
    EXPECT_EQ(t.observed("awake"), 1) << degrees;
  }
  FlatTrial still(R"("bodies": [{"position": [0, -1.6, 0], "mass": 1,
                  "shapes": [{"type": "circle", "radius": 0.2}]}],
                  "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0]}])");
  // After the springs of its joint have taken its weight.
  still.steps(180);
  EXPECT_EQ(still.observed("awake"), 0) << "control: one that hangs still sleeps";
}

}  // namespace
}  // namespace truestep::testing
