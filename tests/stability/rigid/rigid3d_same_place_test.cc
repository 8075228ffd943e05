// Balls at exactly one place used to be pushed apart along one line: a hundred of them remained in one
// another for a minute, and over a floor half of them went through it.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

TEST(Rigid3dSamePlace, BallsPartInAllDirections) {
  Rigid3dDef d;
  for (int k = 0; k < 100; ++k) d.bodies.push_back(testing::ball(0.2, {0, 1, 0}));
  testing::RigidRun run(d, 1.0 / 60, 1, {});
  run.seconds(3);
  // A ball of 7 layers holds a hundred; the line was 40 m long.
  for (size_t i = 0; i < 100; ++i) EXPECT_LT(norm(run.x(i) - Vec3{0, 1, 0}), 4);
  EXPECT_LT(run.observed("penetration"), 0.001);
}

TEST(Rigid3dSamePlace, BallsStayAboveTheFloor) {
  Rigid3dDef d;
  for (int k = 0; k < 100; ++k) d.bodies.push_back(testing::ball(0.2, {0, 1, 0}));
  BoxBodyDef floor = testing::box({50, 0.5, 50}, {0, -0.5, 0});
  floor.motion = BodyDef::Motion::fixed;
  d.bodies.push_back(floor);
  testing::RigidRun run(d);
  run.seconds(3);
  double lowest = 1;
  for (size_t i = 0; i < 100; ++i) lowest = std::min(lowest, run.x(i).y);
  EXPECT_GT(lowest, 0.19);
}

}  // namespace
}  // namespace truestep
