// Random splashes of particles, at defaults in everything but what is drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;
constexpr Method kEvery[] = {Method::dfsph, Method::wcsph, Method::pbf};

bool finite(const SphRun& run) {
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    if (!std::isfinite(norm2(run.position(i)) + norm2(run.velocity(i)))) return false;
  }
  return true;
}

// Energy falls, mass stays, nothing leaves the box.
TEST(SphStability, RandomSplashesStayFiniteAndLoseEnergy) {
  std::mt19937 random(7);
  const auto real = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int k = 0; k < 24; ++k) {
    SphDef d;
    d.dimension = k % 3 == 0 ? 3 : 2, d.spacing = d.dimension == 2 ? real(0.02, 0.05) : real(0.05, 0.08);
    d.solver = kEvery[k / 3 % 3];
    d.kernel = static_cast<Smoothing>(random() % 4), d.support = 2.5;
    if (d.kernel == Smoothing::cubic || d.kernel == Smoothing::poly6_spiky) d.support = 2;
    d.precision = random() % 2 ? Precision::f32 : Precision::f64;
    for (int b = 0; b < 3; ++b) {
      const double r = real(0.08, 0.15);
      d.bodies.push_back({.shape = random() % 2 ? Shape::box : Shape::ball,
                          .center = {0.16 + 0.33 * b, real(0.2, 0.8), 0.5},
                          .half_extents = {r, r, r},
                          .velocity = {real(-3, 3), real(-3, 3), 0},
                          .radius = r});
    }
    SphRun run(d, 1.0 / 60, {0, -9.81, 0});
    const double start = run.observe("energy.total");
    run.seconds(2);
    ASSERT_TRUE(finite(run)) << k;
    EXPECT_LT(run.observe("energy.total"), start) << k;
    EXPECT_GE(run.observe("low.x"), 0) << k;
    EXPECT_LE(run.observe("high.x"), 1) << k;
    EXPECT_GE(run.observe("low.y"), 0) << k;
    EXPECT_LT(run.observe("density.mean_error"), 0.03) << k;
    // Its centre is where the water's would be if evenly spread, provided that it is deeper than a layer or
    // two.
    const double depth = run.observe("mass") / d.density;
    if (depth > 3 * d.spacing) {
      EXPECT_GT(run.observe("centre.y"), 0.8 * depth / 2) << k;
    }
  }
}

}  // namespace
}  // namespace truestep::sph
