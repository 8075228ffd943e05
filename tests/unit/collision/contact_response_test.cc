#include "engine/kernels/contact/contact_response.h"

#include <gtest/gtest.h>

namespace truestep {
namespace {

const Vec3 kUp{0, 1, 0};

TEST(ContactResponse, FrictionlessImpactReversesTheNormalPart) {
  const Vec3 w = impact<double>({3, -2, 1}, kUp, 0.5, 0);
  EXPECT_EQ(w, (Vec3{3, 1, 1}));
}

TEST(ContactResponse, FrictionIsTheSmallerOfGripAndSliding) {
  const Vec3 slides = impact<double>({3, -2, 0}, kUp, 0.5, 0.1);
  EXPECT_DOUBLE_EQ(slides.x, 3 - 0.1 * 1.5 * 2);
  EXPECT_DOUBLE_EQ(slides.y, 1);
  EXPECT_DOUBLE_EQ(impact<double>({0.2, -2, 0}, kUp, 0.5, 0.1).x, 0);
}

TEST(ContactResponse, ImpactNeverGainsEnergy) {
  for (double e = 0; e <= 1; e += 0.25) {
    for (double mu = 0; mu < 3; mu += 0.5) {
      EXPECT_LE(norm2(impact<double>({1, -2, 0.5}, kUp, e, mu)), norm2(Vec3{1, -2, 0.5}) + 1e-15);
    }
  }
}

TEST(ContactResponse, SlidingStopsAfterTheClosedFormDistance) {
  // v^2 / (2 mu g), both for a step within which it stops and for many within which it does not.
  const double v = 3, mu = 0.4, g = 9.81;
  for (const double tau : {1.0, 0.01, 0.0003}) {
    Vec3 w{v, 0, 0};
    double x = 0;
    while (w.x > 0) {
      const auto s = support<double>(w, {0, -g, 0}, kUp, mu, tau);
      x += s.velocity.x * tau + 0.5 * s.acceleration.x * tau * tau;
      w = s.velocity + s.acceleration * tau;
      if (w.x < 1e-12) break;
    }
    EXPECT_NEAR(x, v * v / (2 * mu * g), 1e-12) << tau;  // exact in every step, so rounding alone
  }
}

TEST(ContactResponse, InclineSticksBelowTheAngleOfFriction) {
  const double tan_angle = 0.5;
  const Vec3 pull{-9.81 * tan_angle, -9.81, 0};
  const auto stick = support<double>({}, pull, kUp, 0.51, 0.01);
  EXPECT_EQ(stick.velocity, Vec3{});
  EXPECT_EQ(stick.acceleration, Vec3{});
  const auto slide = support<double>({}, pull, kUp, 0.3, 0.01);
  EXPECT_NEAR(slide.acceleration.x, -9.81 * (tan_angle - 0.3), 1e-13);
  EXPECT_EQ(slide.acceleration.y, 0);
}

TEST(ContactResponse, SinglePrecisionToo) {
  EXPECT_FLOAT_EQ((impact<float>({3, -2, 0}, {0, 1, 0}, 0.5f, 0.1f).x), 2.7f);
}

}  // namespace
}  // namespace truestep
