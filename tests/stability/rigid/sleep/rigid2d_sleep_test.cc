// Bodies in the plane sleep where they rest, not wherever they are slow: not while they fall, swing or drift.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rigid2d_run.h"

namespace truestep {
namespace {

using Trial = testing::FlatTrial;

const char* kGround =
    R"({"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [100, 1, 0]}]})";

TEST(Rigid2dSleep, WhatFallsSlowlyGoesOnFalling) {
  for (const double g : {0.09, 0.001}) {
    Trial t(R"("gravity": [0, )" + std::to_string(-g) +
            R"(, 0], "bodies": [{"position": [0, 10, 0], "shapes": [{"type": "circle", "radius": 0.2}]}])");
    t.steps(240);
    EXPECT_EQ(t.observed("awake"), 1) << g;
    EXPECT_NEAR(t.velocity(0).y, -4 * g, 1e-3 * g) << g;
  }
}

TEST(Rigid2dSleep, APendulumOfOneDegreeGoesOnSwinging) {
  for (const double length : {1.0, 0.3}) {
    const double a = std::acos(-1) / 180;
    Trial t(
        R"("bodies": [{"position": [)" + Trial::number(length * std::sin(a)) + ", " +
        Trial::number(-length * std::cos(a)) +
        R"(, 0], "shapes": [{"type": "circle", "radius": 0.02}]}], "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0]}])");
    t.steps(600);
    EXPECT_EQ(t.observed("awake"), 1) << length;
  }
}

TEST(Rigid2dSleep, WhatDriftsWithoutGravityKeepsItsMomentum) {
  // Two that touch as well: an island without static support.
  Trial t(R"("gravity": [0, 0, 0], "bodies": [
    {"position": [0, 0, 0], "velocity": [0.01, 0, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
    {"position": [5, 0, 0], "velocity": [0.002, 0, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
    {"position": [5.4, 0, 0], "velocity": [0.002, 0, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
    {"position": [9, 0, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]}])");
  t.steps(300);
  EXPECT_NEAR(t.velocity(0).x, 0.01, 1e-8);
  EXPECT_NEAR(t.velocity(1).x, 0.002, 1e-8);
  EXPECT_EQ(t.observed("awake"), 3);  // the fourth does not move at all
}

TEST(Rigid2dSleep, WhatSlidesOnIceGoesOnSliding) {
  Trial t(
      std::string(R"("bodies": [)") + kGround +
      R"(, {"position": [0, 0.2, 0], "velocity": [0.03, 0, 0], "friction": 0, "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]}])");
  t.steps(300);
  EXPECT_NEAR(t.velocity(1).x, 0.03, 1e-6);
}

TEST(Rigid2dSleep, WhatRestsSleepsAndAKickWakesItInOneStep) {
  Trial t(std::string(R"("bodies": [)") + kGround +
          R"(, {"position": [0, 0.2, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
              {"position": [0, 0.6, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]},
              {"position": [-3, 0.2, 0], "velocity": [4, 0, 0], "friction": 0, "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]}])");
  t.steps(36);
  EXPECT_EQ(t.observed("awake"), 1);
  t.steps(12);  // the slider arrives
  EXPECT_EQ(t.observed("awake"), 3);
  EXPECT_GT(t.velocity(1).x, 0.1);
}

}  // namespace
}  // namespace truestep
