// A ball that bounces without loss in space: in the steps that find the ground near, it is moved by substeps,
// by the velocity at their ends, and what it fell too far then was lost in every bounce (3.8 % of its energy
// in a minute from 1 m).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
using testing::RigidRun;
namespace {

/// J above the ground at the start, and those that a minute of bounces from that height takes away.
struct Loss {
  double start, lost;
};

Loss after_a_minute(double height, double restitution, Rigid3dDef::Precision precision) {
  Rigid3dDef d;
  d.precision = precision;
  d.restitution = restitution;
  SphereBodyDef ball = testing::ball(0.2, {0, height + 0.2, 0});
  ball.mass = 1;
  d.bodies = {testing::ground(), ball};
  RigidRun run(d, 1.0 / 60, 1, {0, -9.81, 0});
  const auto energy = [&] { return run.observed("energy.total"); };
  const double start = energy();
  double most = start;
  for (int k = 0; k < 3600; ++k) run.run(1), most = std::max(most, energy());
  // Rounding of 24 bits in some 60 bounces.
  EXPECT_LT(most, start + 1e-5 * start);
  return {9.81 * height, start - energy()};
}

// In the substep of a bounce itself the ball still moves by the velocity at its end: m (g h)^2 / 2.
TEST(Rigid3dBounces, AnElasticBallBouncesForAMinute) {
  for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
    for (const double height : {1.0, 0.7123, 2.3}) {
      const Loss loss = after_a_minute(height, 1, precision);
      const double bounces = 60 / (2 * std::sqrt(2 * height / 9.81)), each = 0.5 * std::pow(9.81 / 300, 2);
      EXPECT_LT(loss.lost, 1.5 * bounces * each) << height;
      EXPECT_GT(loss.lost, -1e-5 * loss.start) << height;
    }
  }
  // The control: a thousandth less restitution.
  EXPECT_GT(after_a_minute(1, 0.999, Rigid3dDef::Precision::f64).lost,
            3 * 60 / (2 * std::sqrt(2 / 9.81)) * 0.5 * std::pow(9.81 / 300, 2));
}

}  // namespace
}  // namespace truestep
