// Rigid bodies in the plane at their limits: stacks, tunnelling shots, sleep, chains' corners, mass ratios.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.h"
#include "tests/support/rigid2d_run.h"

namespace truestep {
namespace {

using Trial = testing::FlatTrial;

const char* kFlatGround =
    R"({"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [100, 1, 0]}]})";

std::string stack(int boxes, const std::string& more) {
  return std::string(R"("bodies": [)") + kFlatGround +
         R"(], "generators": [{"type": "wall", "nx": 1, "ny": )" + std::to_string(boxes) +
         R"(, "origin": [0, 0.5, 0], "spacing": [0, 1, 0],
    "body": {"can_sleep": false, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}}])" +
         more;
}

/// Largest sideways shift of a tower; odd rows may be offset by half a spacing, but the spacing is 0 here.
double lean(Trial& t, int boxes) {
  double most = 0;
  for (int i = 1; i <= boxes; ++i) most = std::max(most, std::abs(t.position(static_cast<size_t>(i)).x));
  return most;
}

TEST(Rigid2dStability, ATowerOfTwentyBoxesStandsForAMinute) {
  Trial t(stack(20, ""));
  t.steps(3600);
  EXPECT_LT(lean(t, 20), 0.01);
  EXPECT_LT(norm(t.velocity(20)), 1e-3);
  // The control: with a thousandth of the stiffness it does not.
  Trial weak(stack(20, R"(, "contact_hertz": 4)"));
  weak.steps(1200);
  EXPECT_GT(lean(weak, 20), 0.01);
}

TEST(Rigid2dStability, TenBoxesAtRestAreAsHighAsTheyAre) {
  Trial t(stack(10, ""));
  t.steps(600);
  // Box 10 stands on ten contacts; MuJoCo's sinks 6 mm in the same scene.
  EXPECT_NEAR(t.position(10).y, 9.5, 1e-4);
  EXPECT_LT(norm(t.velocity(10)), 1e-4);
  // The control: the effect of the contact springs on boxes that do not start at rest.
  Trial falls(
      std::string(R"("bodies": [)") + kFlatGround +
      R"(], "generators": [{"type": "wall", "nx": 1, "ny": 10, "origin": [0, 0.501, 0], "spacing": [0, 1.001, 0],
    "body": {"can_sleep": false, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}}])");
  falls.steps(30);
  EXPECT_GT(9.5 - falls.position(10).y, 1e-3);
}

TEST(Rigid2dStability, AHeavyBoxStandsOnALightOne) {
  Trial t(std::string(R"("substeps": 8, "bodies": [)") + kFlatGround +
          R"(, {"position": [0, 0.5, 0], "density": 10, "can_sleep": false, "shapes": [{"type": "box"}]},
      {"position": [0, 1.5, 0], "density": 10000, "can_sleep": false, "shapes": [{"type": "box"}]}])");
  t.steps(1200);
  EXPECT_NEAR(t.position(2).x, 0, 0.02);
  EXPECT_GT(t.position(2).y, 1.2);
}

TEST(Rigid2dStability, NoShotPassesAThinWall) {
  // A ball of 0.1 m at 300 m/s against walls of 1 cm: 5 m in a step of 1/60 s.
  int through = 0;
  for (uint64_t k = 0; k < 4000; ++k) {
    const auto u = uniform4(3, 1, k), v = uniform4(3, 2, k);
    const std::string speed = std::to_string(50 + 250 * u[0]), y = std::to_string(-1.5 + 3 * u[1]);
    const char* shape =
        v[0] < 0.33   ? R"({"type": "circle", "radius": 0.1})"
        : v[0] < 0.66 ? R"({"type": "box", "half_extents": [0.1, 0.03, 0]})"
                      : R"({"type": "capsule", "from": [-0.1, 0, 0], "to": [0.1, 0, 0], "radius": 0.02})";
    Trial t(R"("gravity": [0, 0, 0], "bodies": [
      {"motion": "fixed", "position": [0, 0, 0], "angle": )" +
            std::to_string(u[2] - 0.5) + R"(, "shapes": [{"type": "box", "half_extents": [0.005, 5, 0]}]},
      {"position": [)" +
            std::to_string(-3 - 4 * u[3]) + ", " + y + R"(, 0], "velocity": [)" + speed +
            R"(, 0, 0], "angle": )" + std::to_string(6 * v[1]) + R"(, "angular_velocity": )" +
            std::to_string(40 * v[2] - 20) + R"(, "shapes": [)" + shape + "]}]");
    const Vec3 normal{std::cos(u[2] - 0.5), std::sin(u[2] - 0.5), 0};
    bool passed = false;
    for (int step = 0; step < 6; ++step) {
      t.steps(1);
      const double depth = dot(normal, t.position(1));
      // A shot that slides off over the wall's rim did not pass through it.
      passed |= depth > 0 && norm(t.position(1) - normal * depth) < 4.8;
    }
    through += passed;
  }
  EXPECT_EQ(through, 0);
}

TEST(Rigid2dStability, ABulletDoesNotPassMovingBodiesButOthersDo) {
  const auto shot = [](const char* bullet) {
    Trial t(std::string(R"("gravity": [0, 0, 0], "bodies": [
      {"position": [0, 0, 0], "density": 8000, "shapes": [{"type": "box", "half_extents": [0.05, 2, 0]}]},
      {"position": [-3.1, 0, 0], "velocity": [200, 0, 0], "bullet": )") +
            bullet + R"(, "shapes": [{"type": "circle", "radius": 0.05}]}])");
    t.steps(5);
    return t.position(1).x > t.position(0).x;
  };
  EXPECT_FALSE(shot("true"));
  EXPECT_TRUE(shot("false"));
}

TEST(Rigid2dStability, NothingCatchesOnFlatGroundMadeOfLinks) {
  std::string points = "[-20, 0, 0]";
  for (int i = -19; i <= 80; ++i) points += ", [" + std::to_string(i) + ", 0, 0]";
  const auto slide = [&](const std::string& ground, const char* shape) {
    Trial t(
        R"("sleeping": false, "bodies": [{"motion": "fixed", "friction": 0, "shapes": [)" + ground +
        R"(]}, {"position": [-10, 0.25, 0], "velocity": [10, 0, 0], "friction": 0, "fixed_rotation": true, "shapes": [)" +
        shape + "]}]");
    t.steps(300);
    EXPECT_LT(std::abs(t.position(1).y - 0.25), 0.01);
    return t.velocity(1).x;
  };
  const std::string chain = R"({"type": "chain", "points": [)" + points + "]}";
  for (const char* shape :
       {R"({"type": "box", "half_extents": [0.25, 0.25, 0]})", R"({"type": "circle", "radius": 0.25})",
        R"({"type": "capsule", "from": [-0.3, 0, 0], "to": [0.3, 0, 0], "radius": 0.25})"}) {
    // Without friction nothing may slow it down at all.
    EXPECT_NEAR(slide(chain, shape), 10, 1e-6) << shape;
  }
}

TEST(Rigid2dStability, WhatDoesNotTurnRestsOnTwoPoints) {
  // Without a moment of inertia both points are fully coupled, and their matrix has no inverse.
  Trial t(
      std::string(R"("sleeping": false, "bodies": [)") + kFlatGround +
      R"(, {"position": [0, 0.25, 0], "fixed_rotation": true, "shapes": [{"type": "box", "half_extents": [0.25, 0.25, 0]}]},
             {"position": [3, 0.25, 0], "shapes": [{"type": "box", "half_extents": [0.25, 0.25, 0]}]}])");
  t.steps(200);
  for (const size_t i : {1, 2}) {
    EXPECT_NEAR(t.position(i).y, 0.25, 1e-4) << i;
    // Half a percent of the points' coupling is left out, relative to g h = 0.16 m/s.
    EXPECT_LT(std::abs(t.velocity(i).y), 1e-3) << i;
  }
}

TEST(Rigid2dStability, WhatSleepsDoesNotMoveAndWakesWhenTouched) {
  Trial t(std::string(R"("bodies": [)") + kFlatGround +
          R"(], "generators": [{"type": "pyramid", "base": 40, "origin": [0, 0.5, 0], "spacing": [1.05, 1, 0],
           "body": {"shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}}])");
  // The control: awake, the pile moves a little in every step.
  t.steps(30);
  const double top = t.position(820).y;
  t.steps(1);
  EXPECT_NE(t.position(820).y, top);
  t.steps(950);
  ASSERT_EQ(t.observed("awake"), 0);
  std::vector<Vec3> before;
  for (size_t i = 1; i <= 820; ++i) before.push_back(t.position(i));
  t.steps(600);
  for (size_t i = 1; i <= 820; ++i) EXPECT_EQ(norm(t.position(i) - before[i - 1]), 0) << i;
  // A push at the top wakes the whole pile, which is one island.
  Command push;
  push.kind = CommandKind::impulse, push.index = 820, push.vector = {500, 0, 0};
  t.world.system(0).apply(t.s(), push);
  EXPECT_EQ(t.observed("awake"), 820);
}

TEST(Rigid2dStability, TheDrumTurnsForAMinute) {
  Trial t(R"("bodies": [{"motion": "kinematic", "angular_velocity": 0.5, "shapes": [
      {"type": "box", "half_extents": [3, 0.3, 0], "center": [0, 3, 0]}, {"type": "box", "half_extents": [3, 0.3, 0], "center": [0, -3, 0]},
      {"type": "box", "half_extents": [0.3, 3, 0], "center": [3, 0, 0]}, {"type": "box", "half_extents": [0.3, 3, 0], "center": [-3, 0, 0]}]}],
    "generators": [{"type": "grid", "nx": 14, "ny": 10, "origin": [-2.3, -2, 0], "spacing": [0.35, 0.35, 0],
      "body": {"shapes": [{"type": "box", "half_extents": [0.12, 0.12, 0]}]}}])");
  t.steps(3600);
  for (size_t i = 1; i <= 140; ++i) EXPECT_LT(norm(t.position(i)), 4.3) << i;
  EXPECT_EQ(t.observed("awake"), 140);
}

}  // namespace
}  // namespace truestep
