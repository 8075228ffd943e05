// What stands in space stays in place and comes to rest with the defaults; what only seems to rest does not
// fall asleep. The theory behind the numbers: docs/standing.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::ball;
using testing::box;
using testing::ground;
using testing::RigidRun;

/// Courses of unit boxes, each on two of the course below.
Rigid3dDef wall(int64_t courses) {
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->layout = CopiesDef::Layout::wall, b.copies->count = {courses}, b.copies->spacing = {1.01, 1, 1};
  d.bodies.push_back(b);
  return d;
}

Rigid3dDef tower(int boxes) {
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  for (int i = 0; i < boxes; ++i) d.bodies.push_back(box({0.5, 0.5, 0.5}, {0, 0.5 + i, 0}));
  return d;
}

/// Flat blocks stacked on a slope of 30 degrees, with gravity rotated instead of the ground.
Rigid3dDef blocks_on_a_slope(int blocks, double friction) {
  Rigid3dDef d;
  d.sleeping = false, d.friction = friction;
  const double a = std::numbers::pi / 6;
  d.gravity = Vec3{9.81 * std::sin(a), -9.81 * std::cos(a), 0};
  d.bodies.push_back(ground());
  for (int i = 0; i < blocks; ++i) d.bodies.push_back(box({0.5, 0.2, 0.5}, {0, 0.2 + 0.4 * i, 0}));
  return d;
}

double fastest_body(const RigidRun& run) {
  double most = 0;
  for (size_t i = 1; i < run.count(); ++i) most = std::max(most, norm(run.v(i)));
  return most;
}

class Rigid3dStanding : public ::testing::TestWithParam<Rigid3dDef::Precision> {
 protected:
  RigidRun start(Rigid3dDef d) const {
    d.precision = GetParam();
    return RigidRun(d);
  }
};

TEST_P(Rigid3dStanding, AWallOfFortyCoursesIsStill) {
  RigidRun run = start(wall(40));
  const Vec3 top = run.x(run.count() - 1);
  run.seconds(5);
  // 820 t: 0.16 J is 0.6 mm/s everywhere. Rapier's top has moved 43 mm sideways and 113 mm down by then.
  EXPECT_LT(run.observed("energy.kinetic"), 0.16);
  EXPECT_LT(norm(run.x(run.count() - 1) - top), 1e-3);
}

TEST_P(Rigid3dStanding, AWallThatIsPushedComesToRest) {
  const auto sways = [&](std::optional<double> hertz) {
    Rigid3dDef d = wall(10);
    d.contact_hertz = hertz;
    RigidRun run = start(d);
    run.seconds(1);
    const auto v = run.state.f64(rigid3d::columns::velocity);
    for (size_t i = 1; i < run.count(); ++i) v[3 * i + 2] += 1e-5 * run.x(i).y;
    run.seconds(1);
    const double soon = run.observed("energy.kinetic");
    run.seconds(15);
    return run.observed("energy.kinetic") / soon;
  };
  EXPECT_LT(sways({}), 0.1);
  // The control: contacts at a fifth of the substeps' rate amplify the sway.
  EXPECT_GT(sways(60), 1);
}

TEST_P(Rigid3dStanding, ThreeBlocksOnASlopeRest) {
  RigidRun run = start(blocks_on_a_slope(3, 0.6));
  run.seconds(5);
  EXPECT_LT(fastest_body(run), 1e-5);
  // The control: tan(30 degrees) = 0.577 is what holds them.
  RigidRun loose = start(blocks_on_a_slope(3, 0.56));
  loose.seconds(5);
  EXPECT_GT(fastest_body(loose), 0.1);
}

TEST_P(Rigid3dStanding, ATowerOfFiftyStandsAtTheDefaults) {
  Rigid3dDef d = tower(50);
  // A tiny velocity, so that it does not stand by symmetry alone.
  std::get<BoxBodyDef>(d.bodies.back()).velocity = {1e-5, 0, 0};
  RigidRun run = start(d);
  run.seconds(20);
  const Vec3 top = run.x(50);
  // Five substeps hold 16 boxes; a falling tower is metres off after 20 s.
  EXPECT_LT(std::hypot(top.x, top.z), 0.01);
  EXPECT_LT(fastest_body(run), 0.01);
}

TEST_P(Rigid3dStanding, TallTowersTakeMoreSubsteps) {
  const auto substeps = [&](const Rigid3dDef& d) {
    RigidRun run = start(d);
    run.run(20);
    return std::lround(run.h / run.state.f64(rigid3d::columns::substep)[0]);
  };
  EXPECT_GE(substeps(tower(50)), 10);
  // The control: what five substeps hold keeps five, and a wall that narrows is not a tower.
  EXPECT_EQ(substeps(tower(12)), 5);
  EXPECT_EQ(substeps(wall(20)), 5);
}

TEST_P(Rigid3dStanding, WhatDriftsInSpaceDoesNotFallAsleep) {
  Rigid3dDef d;
  d.gravity = Vec3{};
  BoxBodyDef a = box({0.5, 0.5, 0.5}, {0, 0, 0}), b = box({0.5, 0.5, 0.5}, {0, 1, 0});
  a.velocity = b.velocity = {0.01, 0, 0.005};
  d.bodies = {a, b};
  RigidRun run = start(d);
  run.seconds(5);
  EXPECT_EQ(run.observed("awake"), 2);
  EXPECT_NEAR(run.x(0).x, 0.05, 1e-6);
  EXPECT_NEAR(run.x(1).z, 0.025, 1e-6);
}

TEST_P(Rigid3dStanding, WhatGlidesOnSmoothGroundDoesNotFallAsleep) {
  Rigid3dDef d;
  d.friction = 0;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.velocity = {0.01, 0, 0};
  d.bodies.push_back(b);
  RigidRun run = start(d);
  run.seconds(5);
  EXPECT_NEAR(run.v(1).x, 0.01, 1e-6);
  // The control: with friction it stops and sleeps.
  d.friction = 0.5;
  RigidRun rough = start(d);
  rough.seconds(5);
  EXPECT_EQ(rough.observed("awake"), 0);
}

INSTANTIATE_TEST_SUITE_P(Precisions, Rigid3dStanding,
                         ::testing::Values(Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64),
                         [](const auto& info) {
                           return info.param == Rigid3dDef::Precision::f32 ? "f32" : "f64";
                         });

}  // namespace
}  // namespace truestep
