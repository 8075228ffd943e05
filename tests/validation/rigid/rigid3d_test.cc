// Rigid bodies in 3-D against closed forms and quadruple-precision references.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/kernels/rigid/free_rotation.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::ball;
using testing::box;
using testing::ground;
using testing::RigidRun;

constexpr double kSpaceGravity = 9.81;

double angle_between(const Quat& a, const Quat& b) {
  return norm(free_rotation::rotation_vector(a * Quat{b.w, -b.x, -b.y, -b.z}));
}

/// A box 3 x 2 x 1 that rotates about none of its own axes.
Rigid3dDef top() {
  Rigid3dDef d;
  BoxBodyDef b = box({1.5, 1, 0.5}, {});
  b.angular_velocity = {1, 2, 3};
  d.bodies.push_back(b);
  return d;
}

TEST(Rigid3dFreeTop, SixtyStepsASecondFollowItToAMicroradian) {
  RigidRun coarse(top(), 1.0 / 60, 1, {}), fine(top(), 1.0 / 6000, 1, {});
  const double lx = coarse.observed("angular_momentum.x"), energy = coarse.observed("energy.kinetic");
  coarse.seconds(10), fine.seconds(10);
  // Ten seconds at 60 Hz: game engines are off by 0.15 to 1.3 rad here.
  EXPECT_LT(angle_between(coarse.q(0), fine.q(0)), 1e-6);
  EXPECT_NEAR(coarse.observed("angular_momentum.x"), lx, 1e-11 * std::abs(lx));
  EXPECT_NEAR(coarse.observed("energy.kinetic"), energy, 1e-10 * energy);
  // The control: one Euler step of w in the body's frame fails.
  Quat q;
  Vec3 w{1, 2, 3}, I{5, 10, 13};
  for (int k = 0; k < 600; ++k) {
    w += Vec3{(I.y - I.z) * w.y * w.z / I.x, (I.z - I.x) * w.z * w.x / I.y, (I.x - I.y) * w.x * w.y / I.z} /
         60.0;
    q = normalized(q * free_rotation::turn(w / 60.0));
  }
  EXPECT_GT(angle_between(q, fine.q(0)), 1e-2);
}

TEST(Rigid3dFreeTop, HasFourthOrder) {
  // Steps in which the body rotates by less than one part of free_rotation (0.03 rad), so that halving the
  // step halves the method's own step.
  const auto state_after = [](double h) {
    free_rotation::Motion m{{}, {1, 2, 3}};
    for (int k = 0; k < std::lround(2.1 / h); ++k) m = free_rotation::advance(m, {5, 10, 13}, h);
    return m.orientation;
  };
  const Quat fine = state_after(7e-4);
  const double coarse = angle_between(state_after(0.007), fine),
               half = angle_between(state_after(0.0035), fine);
  EXPECT_NEAR(std::log2(coarse / half), 4, 0.15);
}

TEST(Rigid3dFreeTop, SymmetricBodiesAreExact) {
  // I = (1, 3, 1): two different steps agree to rounding.
  const auto after = [](int steps) {
    free_rotation::Motion m{normalized(Quat{1, 2, 3, 4}), {3, -2, 5}};
    for (int k = 0; k < steps; ++k) m = free_rotation::advance(m, {1, 3, 1}, 10.0 / steps);
    return m;
  };
  EXPECT_LT(angle_between(after(1).orientation, after(1000).orientation), 1e-10);
  EXPECT_LT(norm(after(1).angular_velocity - after(1000).angular_velocity), 1e-9);
}

TEST(Rigid3dFreeFall, IsExactAtAnyStep) {
  Rigid3dDef d;
  d.bodies.push_back(ball(0.1, {0, 100, 0}));
  std::get<SphereBodyDef>(d.bodies[0]).velocity = {3, 4, 0};
  RigidRun run(d, 0.25);
  run.seconds(2);
  EXPECT_NEAR(run.x(0).x, 6, 1e-12);
  EXPECT_NEAR(run.x(0).y, 100 + 8 - 0.5 * kSpaceGravity * 4, 1e-12);
}

/// A block on a slope of 30 degrees: the plane is level and gravity is tilted.
RigidRun slope(double friction, double h) {
  Rigid3dDef d;
  d.friction = friction, d.sleeping = false;
  d.bodies.push_back(ground());
  d.bodies.push_back(box({0.5, 0.25, 0.5}, {0, 0.25, 0}));
  const double a = std::numbers::pi / 6;
  return RigidRun(d, h, 1, Vec3{std::sin(a), -std::cos(a), 0} * kSpaceGravity);
}

TEST(Rigid3dContact, ABlockSlidesDownASlope) {
  // contact.incline: mu = 0.3, a = g (sin - mu cos) = 2.3562872366 m/s^2.
  RigidRun run = slope(0.3, 1.0 / 480);
  run.seconds(1);
  EXPECT_NEAR(run.x(1).x, 1.178143618331198531, 1e-3 * 1.178);
}

TEST(Rigid3dContact, ABlockThatShouldStickDoesNotCreep) {
  // mu = 0.6 > tan(30 degrees) = 0.577; soft-contact engines creep here at 2e-3 m/s.
  RigidRun run = slope(0.6, 1.0 / 60);
  run.seconds(1);
  const double x = run.x(1).x;
  run.seconds(1);
  EXPECT_LT(std::abs(run.x(1).x - x), 1e-5);
  // The control: just below the critical coefficient it slides away.
  RigidRun slides = slope(0.55, 1.0 / 60);
  slides.seconds(2);
  EXPECT_GT(slides.x(1).x, 0.1);
}

TEST(Rigid3dContact, ASlidingBlockStops) {
  // contact.slide_stop: v0 = 3 m/s, mu = 0.4: t = 0.7645 s, x = 1.1468 m.
  Rigid3dDef d;
  d.friction = 0.4;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.1, 0.5}, {0, 0.1, 0});
  b.velocity = {3, 0, 0};
  d.bodies.push_back(b);
  RigidRun run(d, 1.0 / 480);
  run.seconds(1.5);
  EXPECT_NEAR(run.x(1).x, 1.146788990825688, 1e-3 * 1.1468);
  EXPECT_LT(norm(run.v(1)), 1e-6);
}

TEST(Rigid3dContact, ABowlingBallBeginsToRoll) {
  // contact.bowling: v0 = 2 m/s without spin, mu = 0.2: it rolls from t = 0.2912 s on at 5/7 v0.
  Rigid3dDef d;
  d.friction = 0.2;
  d.bodies.push_back(ground());
  SphereBodyDef b = ball(0.11, {0, 0.11, 0});
  b.velocity = {2, 0, 0};
  d.bodies.push_back(b);
  RigidRun run(d, 1.0 / 240);
  run.seconds(0.25);
  EXPECT_GT(run.v(1).x, 1.43 + 0.05);  // still sliding
  run.seconds(0.25);
  EXPECT_NEAR(run.v(1).x, 10.0 / 7, 1e-3 * 1.43);
  EXPECT_NEAR(run.w(1).z, -10.0 / 7 / 0.11, 1e-3 * 13);
}

TEST(Rigid3dContact, ABouncingBallComesToRest) {
  // contact.zeno_08: from 1 m with e = 0.8 it stops after 4.0637 s.
  Rigid3dDef d;
  d.restitution = 0.8, d.restitution_speed = 0.02;
  d.bodies.push_back(ground());
  d.bodies.push_back(ball(0.1, {0, 1.1, 0}));
  RigidRun run(d, 1.0 / 960);
  double stopped = 0;
  for (int k = 0; k < 960 * 5; ++k) {
    run.run(1);
    if (std::abs(run.v(1).y) > 0.02 || run.x(1).y > 0.101) stopped = run.t();
  }
  EXPECT_NEAR(stopped, 4.0637127688715781, 0.02 * 4.06);
}

TEST(Rigid3dContact, ABallPassesNoThinWall) {
  // 0.1 m across at 300 m/s: 5 m per step, against a wall of 1 cm, from many positions and directions.
  for (int k = 0; k < 50; ++k) {
    Rigid3dDef d;
    BoxBodyDef wall = box({0.005, 3, 3}, {});
    wall.motion = BodyDef::Motion::fixed;
    d.bodies.push_back(wall);
    SphereBodyDef b = ball(0.05, {-1 - 0.173 * k, 0.02 * k, -0.015 * k});
    b.velocity = {300, 0.7 * k, 0.3 * k};
    d.bodies.push_back(b);
    RigidRun run(d, 1.0 / 60, 1, {});
    run.run(20);
    EXPECT_LT(run.x(1).x, -0.0549) << k;
  }
}

TEST(Rigid3dStack, TwentyBoxesStandForAMinute) {
  // Jolt's, Bullet's and ODE's fall within ten seconds; Rapier's leans by 4 mm.
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->count = {1, 20, 1};
  d.bodies.push_back(b);
  RigidRun run(d);
  run.seconds(60);
  const Vec3 top = run.x(20);
  EXPECT_LT(std::hypot(top.x, top.z), 1e-4);
  EXPECT_NEAR(top.y, 19.5, 1e-3);  // springs of 60 Hz alone: 28 mm lower
  EXPECT_LT(run.observed("penetration"), 1e-4);
  // The control: a body pushed aside does not return.
  Command c;
  c.kind = CommandKind::impulse, c.index = 20, c.vector = {6000, 0, 0};
  run.apply(c);
  run.seconds(2);
  EXPECT_GT(run.x(20).x, 0.5);
}

TEST(Rigid3dSleep, AHeapAtRestIsFreeAndWakesWhenItIsHit) {
  Rigid3dDef d;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->layout = CopiesDef::Layout::pyramid, b.copies->count = {5}, b.copies->spacing = {1.05, 1, 1.05};
  d.bodies.push_back(b);
  SphereBodyDef far = ball(0.5, {50, 0.5, 0});
  d.bodies.push_back(far);
  RigidRun run(d);
  run.seconds(4);
  ASSERT_EQ(run.observed("awake"), 0);
  const State asleep = run.state;
  run.run(10);
  EXPECT_EQ(run.state, asleep);
  Command c;
  c.kind = CommandKind::impulse, c.index = static_cast<int64_t>(run.count()) - 1, c.vector = {-8000, 0, 0};
  run.apply(c);
  EXPECT_EQ(run.observed("awake"), 1);
  for (int k = 0; k < 600 && run.observed("awake") < 3; ++k) run.run(1);
  EXPECT_EQ(run.observed("awake"), run.count() - 1.0);  // all but the ground, at the first touch
}

/// A rod of 1 m that hangs from the world by one end, released level.

}  // namespace
}  // namespace truestep
