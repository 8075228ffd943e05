// Contact by a barrier against closed forms: sliding on a slope, and momentum between bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

// A stiff block that rests on a floor under gravity tilted by an angle.
FemDef block(double friction) {
  FemDef d;
  d.block = SoftBlockShape{{-0.2, 2e-4, -0.2}, {0.4, 0.1, 0.4}, 4, 1, 4};
  d.element = Cell::hex8, d.material = Law::corotated, d.youngs_modulus = 1e6;
  d.friction = friction, d.contact = Meeting::barrier, d.contact_distance = 5e-4;
  d.colliders.push_back(PlaneColliderDef{});
  return d;
}
double middle(const FemRun& run) {
  double x = 0;
  for (size_t i = 0; i < run.system->body().mesh.x.size(); ++i) x += run.displacement(i).x;
  return x / static_cast<double>(run.system->body().mesh.x.size());
}

double speed(const FemRun& run) {
  return run.observe("momentum.x") / (1000 * 0.4 * 0.1 * 0.4);
}

// Coulomb: below the angle of friction it stays, above it slides with g (sin a - mu cos a).
TEST(FemBarrierFriction, ABlockOnASlopeSticksOrSlides) {
  constexpr double kMu = 0.5, kG = 9.81, kDt = 0.005;
  for (const double degrees : {20.0, 35.0}) {
    const double a = degrees * 3.14159265358979 / 180;
    FemRun run(block(kMu), kDt, {kG * std::sin(a), -kG * std::cos(a), 0});
    // It is released slightly above its rest, and has reached it by then.
    run.seconds(0.3);
    const double v = speed(run), x = middle(run);
    run.seconds(0.3);
    const double gain = 0.3 * std::max(0.0, kG * (std::sin(a) - kMu * std::cos(a)));
    // A sticking block creeps at most at the slip speed of the smoothed friction, 1e-3 of the body's size per
    // second.
    EXPECT_NEAR(speed(run) - v, gain, 0.005 * gain + 1e-3 * 0.58) << degrees;
    EXPECT_NEAR(gain == 0 ? middle(run) - x : 0, 0, 1e-3 * 0.58 * 0.3);
  }
  // The control: without friction it slides where it stuck.
  const double a = 20 * 3.14159265358979 / 180;
  FemRun ice(block(0), kDt, {kG * std::sin(a), -kG * std::cos(a), 0});
  ice.seconds(0.3);
  const double v = speed(ice);
  ice.seconds(0.3);
  EXPECT_NEAR(speed(ice) - v, 0.3 * kG * std::sin(a), 1e-6);
}

// Two cubes collide in empty space, with friction: what one loses the other gains. Only the imbalance left by
// Newton's method can differ.
TEST(FemBarrierFriction, BodiesThatCollideKeepTheirMomentum) {
  FemDef d;
  d.block = SoftBlockShape{{-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}, 2, 2, 2};
  d.element = Cell::tet4, d.youngs_modulus = 1e5, d.friction = 0.5, d.contact = Meeting::barrier;
  d.copies = {{{-0.2, 0, 0}, {0, 0, 1}, {2, 0, 0}, 0.3}, {{0.2, 0.05, 0.02}, {1, 1, 0}, {-1, 0, 0}, 0.7}};
  FemRun run(d, 1.0 / 200);
  const double before = run.observe("momentum.x"), kinetic = run.observe("energy.kinetic");
  size_t touched = 0;
  for (int k = 0; k < 60; ++k) {
    run.step();
    touched += run.observe("contact.pairs") > 0;
  }
  EXPECT_GT(touched, 3u);
  EXPECT_NEAR(run.observe("momentum.x"), before, 1e-6 * before);
  EXPECT_NEAR(run.observe("momentum.y"), 0, 1e-6 * before);
  EXPECT_NEAR(run.observe("momentum.z"), 0, 1e-6 * before);
  // And they did collide: a cube that flew on would have kept its energy.
  EXPECT_LT(run.observe("energy.kinetic"), 0.9 * kinetic);
}

// The weight of a block on the floor is carried by the barrier: gravity against the elastic remainder of the
// reaction.
TEST(FemBarrierFriction, WhatRestsIsCarried) {
  FemDef d = block(0.5);
  d.damping = 20;
  FemRun run(d, 0.01, {0, -9.81, 0});
  run.seconds(2);
  EXPECT_LT(run.observe("energy.kinetic"), 1e-9);
  EXPECT_GT(run.observe("contact.gap"), 0);
  EXPECT_LT(run.observe("contact.gap"), 5e-4);
  // It neither hovers nor has it sunk in: all nodes of the bottom are within reach.
  EXPECT_GE(run.observe("contact.pairs"), 25);
}

}  // namespace
}  // namespace truestep::fem
