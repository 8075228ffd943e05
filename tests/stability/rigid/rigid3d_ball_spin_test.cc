// Balls touch on a patch: one that spins upright comes to rest, and the heap in which it lies falls asleep.
// Without the patch, a heap of mixed shapes was kept awake forever by one ball that spun at 0.45 rad/s.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
using testing::RigidRun;
namespace {

constexpr double kRadius = 0.45, kFriction = 0.6, kSpin = 0.45;

Rigid3dDef ball_on_ground(std::optional<double> spinning_resistance) {
  Rigid3dDef d;
  d.friction = kFriction, d.spinning_resistance = spinning_resistance;
  PlaneBodyDef ground;
  ground.motion = BodyDef::Motion::fixed;
  SphereBodyDef ball = testing::ball(kRadius, {0, kRadius, 0});
  ball.angular_velocity = {0, kSpin, 0};
  d.bodies = {ground, ball};
  return d;
}

// The torque on a round patch of radius a under Hertz's pressure is 3 pi / 16 mu N a (Johnson 1985, 3.8), on
// a ball of 2/5 m R^2: w' = -(15 pi / 32) mu g a / R^2, with a = R / 100.
TEST(Rigid3dBallSpin, FadesByFrictionOnAPatchAndTheBallSleeps) {
  RigidRun run(ball_on_ground({}));
  const double rate = 15 * std::numbers::pi / 32 * kFriction * 9.81 * 0.01 / kRadius;
  run.seconds(1);
  // Loads settle within a few steps of a sixtieth.
  EXPECT_NEAR(run.w(1).y, kSpin - rate, 0.03 * rate);
  run.seconds(kSpin / rate - 1 + 1);
  EXPECT_EQ(run.observed("awake"), 0) << "a second after the spin has ended";
  // The control: without a patch nothing slows it down.
  RigidRun control(ball_on_ground(0.0));
  control.seconds(4);
  EXPECT_NEAR(control.w(1).y, kSpin, 1e-4);
  EXPECT_EQ(control.observed("awake"), 1);
}

TEST(Rigid3dBallSpin, NeedsFriction) {
  Rigid3dDef d = ball_on_ground({});
  d.friction = 0;
  RigidRun run(d);
  run.seconds(1);
  EXPECT_NEAR(run.w(1).y, kSpin, 1e-6);
}

}  // namespace
}  // namespace truestep
