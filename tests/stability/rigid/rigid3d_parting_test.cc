// Bodies that overlapped and separate fast used to be put back in every step forever, while gravity kept
// accelerating them.
#include <gtest/gtest.h>

#include "tests/support/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

TEST(Rigid3dFastBodies, ThatAreInOneAnotherMayPart) {
  Rigid3dDef d;
  SphereBodyDef a = testing::ball(0.5, {}), b = testing::ball(0.5, {0.3, 0, 0});
  b.velocity = {40, 0, 0};
  d.bodies = {a, b};
  testing::RigidRun run(d, 1.0 / 60, 1, {});
  run.run(10);
  EXPECT_GT(run.x(1).x - run.x(0).x, 5);
  // The control: a wall in the ball's way stops it.
  BoxBodyDef wall = testing::box({0.005, 3, 3}, {3, 0, 0});
  wall.motion = BodyDef::Motion::fixed;
  d.bodies.push_back(wall);
  testing::RigidRun stopped(d, 1.0 / 60, 1, {});
  stopped.run(10);
  EXPECT_LT(stopped.x(1).x, 3);
}

}  // namespace
}  // namespace truestep
