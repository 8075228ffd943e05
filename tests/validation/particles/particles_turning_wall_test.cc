// Points on rotating walls: their motion there is of second order in the step.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

constexpr double kWallSpin = 0.9, kGravity = 9.81;

/// A point on the ground 1.5 m from the axis z about which the ground turns.
ParticlesDef on_turning_ground(double friction) {
  ParticlesDef d;
  d.positions = {{1.5, 2e-9, 0}};
  d.velocities = {{0, 1.5 * kWallSpin, 0}};
  PlaneColliderDef ground;
  ground.friction = friction, ground.restitution = 0.5;
  ground.motion = MotionDef{};
  ground.motion->spin = {0, 0, kWallSpin};
  d.colliders = {ground};
  return d;
}

struct End {
  Vec3 x, v;
};
End after(const ParticlesDef& d, double time, int steps) {
  ParticlesRun r(d, time / steps);
  r.run(static_cast<uint64_t>(steps));
  return {r.x(0), r.v(0)};
}

TEST(ParticlesTurningWall, WhatSticksHasTheWallsVelocity) {
  // Friction holds up to a slope of atan 5: after 1 s position and velocity are the wall's, up to a slop of
  // 1e-9 m that each of 120 steps may add.
  const End e = after(on_turning_ground(5), 1, 120);
  const Vec3 place = Vec3{std::cos(kWallSpin), std::sin(kWallSpin), 0} * 1.5;
  EXPECT_LT(norm(e.x - place), 3e-7);
  EXPECT_LT(norm(e.v - Vec3{-place.y, place.x, 0} * kWallSpin), 3e-7);
  const Vec3 step_ago = Vec3{std::cos(kWallSpin * 119 / 120), std::sin(kWallSpin * 119 / 120), 0} * 1.5;
  EXPECT_GT(norm(e.x - step_ago), 1e-2);  // control: one step late, as velocities once were
}

TEST(ParticlesTurningWall, WhatSlidesIsOfSecondOrder) {
  // Without friction, along the slope: s'' = omega^2 s - g sin(omega t), from rest at 1.5 m.
  const double t = 1, c = std::cosh(kWallSpin * t), q = kGravity / (2 * kWallSpin * kWallSpin);
  // s = A cosh + B sinh + q sin, s(0) = 1.5, s'(0) = 0.
  const double s = 1.5 * c - q * std::sinh(kWallSpin * t) + q * std::sin(kWallSpin * t);
  const double rate = kWallSpin * (1.5 * std::sinh(kWallSpin * t) - q * c + q * std::cos(kWallSpin * t));
  const Vec3 e{std::cos(kWallSpin * t), std::sin(kWallSpin * t), 0}, n{-e.y, e.x, 0};
  const Vec3 place = e * s, velocity = e * rate + n * (kWallSpin * s);
  const auto error = [&](int steps) {
    const End got = after(on_turning_ground(0), t, steps);
    return norm(got.x - place) + norm(got.v - velocity);
  };
  const double coarse = error(30), fine = error(60);
  EXPECT_LT(coarse, 3e-3);
  EXPECT_GT(coarse / fine, 3.6);  // 4: second order; 2 before
  EXPECT_LT(coarse / fine, 4.4);
}

}  // namespace
}  // namespace truestep
