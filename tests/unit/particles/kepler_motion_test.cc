// Kepler motion by universal variables against closed solutions and itself, on ellipses, parabolas and
// hyperbolas.
#include <gtest/gtest.h>

#include "engine/kernels/gravity/kepler_motion.h"

namespace truestep::gravity {
namespace {

constexpr double kTurn = 6.283185307179586;

TEST(KeplerMotion, TheCaseOfAThinEllipse) {
  // nbody.kepler_e099: mu = 1, from the pericentre of e = 0.99, to t = 3.5 (mpmath, 30 digits).
  Vec3 x{0.01, 0, 0}, v{0, std::sqrt(1.99 / 0.01), 0};
  kepler_motion(x, v, 1, 3.5);
  // The passage amplifies the rounding of the start: a relative 1e-16 of the period moves the body by 1e-16 v
  // t.
  EXPECT_NEAR(x.x, -1.97373758141097163, 3e-14);
  EXPECT_NEAR(x.y, -0.02533735150527517338, 3e-14);
  EXPECT_NEAR(v.x, 0.090993314737247286587, 3e-14);
  EXPECT_NEAR(v.y, -0.0703040928558162193, 3e-14);
}

TEST(KeplerMotion, KeepsWhatKeplersMotionKeepsAndGoesBack) {
  for (const double speed :
       {0.3, 0.9, 1.0, 1.3, std::sqrt(2.0), 1.6, 4.0}) {  // ellipses, circle, parabola, hyperbolas
    for (const double h : {1e-6, 0.1, 1.0, 7.0, 100.0, -3.0}) {
      const Vec3 x0{1, 0.2, -0.1}, v0{-0.1, speed, 0.2};
      Vec3 x = x0, v = v0;
      kepler_motion(x, v, 1, h);
      const double energy = 0.5 * norm2(v0) - 1 / norm(x0);
      EXPECT_NEAR(0.5 * norm2(v) - 1 / norm(x), energy, 2e-14 * (1 + norm2(v))) << speed << " " << h;
      EXPECT_LT(norm(cross(x, v) - cross(x0, v0)), 2e-14 * norm(x) * norm(v)) << speed << " " << h;
      kepler_motion(x, v, 1, -h);
      EXPECT_LT(norm(x - x0), 1e-12 * (1 + std::abs(h))) << speed << " " << h;
    }
  }
}

TEST(KeplerMotion, ACircleTurnsAsTimeSays) {
  for (const double turns : {0.25, 1.0, 1000.25}) {
    Vec3 x{2, 0, 0}, v{0, std::sqrt(3 / 2.0), 0};
    const double t = turns * kTurn * std::sqrt(8 / 3.0), angle = kTurn * (turns - std::floor(turns));
    kepler_motion(x, v, 3, t);
    // A relative rounding of t and of the period, times the angle that has been turned.
    EXPECT_LT(norm(x - Vec3{2 * std::cos(angle), 2 * std::sin(angle), 0}),
              2 * (1e-15 + 4e-16 * kTurn * turns))
        << turns;
  }
  // Control: another strength gives another angle.
  Vec3 x{2, 0, 0}, v{0, std::sqrt(3 / 2.0), 0};
  kepler_motion(x, v, 3.001, kTurn * std::sqrt(8 / 3.0));
  EXPECT_GT(norm(x - Vec3{2, 0, 0}), 1e-3);
}

TEST(KeplerMotion, StraightOnWithoutACentre) {
  Vec3 x{1, 2, 3}, v{1, 0, -1};
  kepler_motion(x, v, 0, 2);
  EXPECT_EQ(x, (Vec3{3, 2, 1}));
}

}  // namespace
}  // namespace truestep::gravity
