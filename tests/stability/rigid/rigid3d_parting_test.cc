// Bodies that overlapped and separate fast used to be put back in every step forever, while gravity kept
// accelerating them; so was what had been pressed into the ground so deeply that the ground cut its core.
#include <gtest/gtest.h>

#include "tests/support/runs/rigid3d_run.h"

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

/// A ball of 0.25 m that spins fast enough to be swept, with its centre at this height; its core is 0.0625 m.
double height_after(double seconds, double start, Vec3 spin, const AnyBodyDef& floor) {
  Rigid3dDef d;
  SphereBodyDef b = testing::ball(0.25, {0, start, 0});
  b.angular_velocity = spin;
  d.bodies = {floor, b};
  testing::RigidRun run(d, 1.0 / 30);
  run.seconds(seconds);
  return run.x(1).y;
}

// Seed 354963 of the campaign: a heavy box had pressed a spinning ball 0.19 m into the ground, where it
// stayed, because the sweep from its start found it in touch at once.
TEST(Rigid3dFastBodies, WhoseCoresAreCutByTheGroundMayRise) {
  BoxBodyDef slab = testing::box({3, 0.5, 3}, {0, -0.5, 0});
  slab.motion = BodyDef::Motion::fixed;
  for (const AnyBodyDef& floor : {AnyBodyDef(testing::ground()), AnyBodyDef(slab)}) {
    for (const Vec3 spin : {Vec3{0, 0, -16}, Vec3{0, 16, 0}, Vec3{-7, 0, -14}}) {
      for (const double start : {0.06, 0.03, 0.005}) {
        // It used to stay at `start`; a spinning ball may hop by a millimetre.
        EXPECT_NEAR(height_after(2, start, spin, floor), 0.25, 2e-3) << "from " << start;
      }
    }
  }
}

// The control: what moves on into a thin wall that cuts its core is held, on both sides.
TEST(Rigid3dFastBodies, WhoseCoresAreCutByAWallDoNotPass) {
  for (const double side : {1.0, -1.0}) {
    Rigid3dDef d;
    BoxBodyDef wall = testing::box({0.005, 3, 3}, {});
    wall.motion = BodyDef::Motion::fixed;
    SphereBodyDef b = testing::ball(0.25, {side * 0.05, 0, 0});
    b.velocity = {-side * 40, 0, 0};
    d.bodies = {wall, b};
    testing::RigidRun run(d, 1.0 / 60, 1, {});
    run.seconds(1);
    EXPECT_GT(side * run.x(1).x, 0);
  }
}

}  // namespace
}  // namespace truestep
