// What flies freely in the plane follows its parabola: substeps that move bodies by the velocity at their
// ends fall too fast by g h t / 2 (4 cm after two seconds), and a ball that bounces without loss lay still
// after a minute.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/rigid2d_run.h"

namespace truestep {
namespace {

const std::string kDisk = R"("mass": 1, "shapes": [{"type": "circle", "radius": 0.2}])";

std::string gravity(const std::string& precision) {
  return R"("gravity": [0, -9.81, 0], "precision": ")" + precision + "\", ";
}

TEST(Rigid2dFreeFlight, FollowsItsParabola) {
  for (const double dt : {1.0 / 60, 1.0 / 15}) {
    for (const char* precision : {"f64", "f32"}) {
      testing::FlatTrial t(gravity(precision) + R"("bodies": [{"velocity": [3, 10, 0], )" + kDisk + "}]", dt);
      const int steps = static_cast<int>(2 / dt + 0.5);
      t.steps(steps);
      // Single precision: each of 480 substeps rounds a velocity of 10 m/s.
      const double rounding = precision == std::string("f64") ? 1e-12 : 1e-4;
      EXPECT_NEAR(t.position(0).x, 6, rounding);
      EXPECT_NEAR(t.position(0).y, 10 * 2 - 0.5 * 9.81 * 2 * 2, rounding) << precision << ' ' << dt;
    }
  }
}

TEST(Rigid2dFreeFlight, AConstantTorqueTurnsByHalfItsRateTimesTimeSquared) {
  testing::FlatTrial t(R"("gravity": [0, 0, 0], "precision": "f64", "bodies": [{"torque": 0.1, )" + kDisk +
                       "}]");
  t.steps(60);
  const double inertia = 0.5 * 1 * 0.2 * 0.2;
  EXPECT_NEAR(t.angle(0), 0.5 * 0.1 / inertia, 1e-12);
}

// The control: what something holds is moved by its substeps alone. A pendulum keeps its energy by them.
TEST(Rigid2dFreeFlight, WhatAJointHoldsIsNotInFreeFlight) {
  testing::FlatTrial t(gravity("f64") + R"("bodies": [{"position": [1, 0, 0], )" + kDisk + "}]," +
                       R"("joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0]}])");
  const double start = t.observed("energy.total");
  double most = start, least = start;
  for (int k = 0; k < 600; ++k) {
    t.steps(1);
    most = std::max(most, t.observed("energy.total")), least = std::min(least, t.observed("energy.total"));
  }
  // Velocities half a substep later than the positions: m g v h / 2 to either side at 4.4 m/s.
  EXPECT_LT(most - least, 2.5 * 0.5 * 9.81 * 4.4 / 240);
}

// A pull that has not reached a body yet does not part it from its neighbour: bodies with joints are all
// moved by their substeps. The 19,800 joints of the benchmark's grid gaped by 1.01 m instead of 0.49 m.
TEST(Rigid2dFreeFlight, WhatIsJoinedFallsAlike) {
  testing::FlatTrial t(gravity("f64") + R"("bodies": [{)" + kDisk + R"(}, {"position": [1, 0, 0], )" + kDisk +
                       R"(}, {"position": [9, 0, 0], )" + kDisk + "}]," +
                       R"("joints": [{"type": "revolute", "a": 0, "b": 1, "anchor": [0.5, 0, 0]}])");
  t.steps(1);
  const double h = 1.0 / 240, substeps = 1 + 2 + 3 + 4;
  EXPECT_NEAR(t.position(0).y, -9.81 * h * h * substeps, 1e-12);
  EXPECT_NEAR(t.position(1).y, -9.81 * h * h * substeps, 1e-12);
  // The control flies freely.
  EXPECT_NEAR(t.position(2).y, -9.81 * h * h * 8, 1e-12);
}

// In the substep h of a bounce itself the ball still moves by the velocity at its end, which costs
// m (g h)^2 / 2: 0.0085 % of m g h.
TEST(Rigid2dFreeFlight, AnElasticBallBouncesForAMinute) {
  for (const double height : {1.0, 0.7123, 2.3}) {
    testing::FlatTrial t(
        gravity("f32") +
        R"("bodies": [{"motion": "fixed", "position": [0, -1, 0], "restitution": 1, "shapes": [{"type": "box", "half_extents": [50, 1, 0]}]}, {"restitution": 1, "position": [0, )" +
        testing::FlatTrial::number(height + 0.2) + ", 0], " + kDisk + "}]");
    const double start = t.observed("energy.total");
    t.steps(3600);
    const double bounces = 60 / (2 * std::sqrt(2 * height / 9.81)), each = 0.5 * 9.81 * 9.81 / (240 * 240);
    EXPECT_LT(t.observed("energy.total"), start + 1e-6 * start) << height;
    EXPECT_GT(t.observed("energy.total"), start - 1.5 * bounces * each) << height;
  }
}

}  // namespace
}  // namespace truestep
