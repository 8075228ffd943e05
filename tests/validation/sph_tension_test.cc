// Surface tension: drops swing as Rayleigh's formula says, and an edge goes round.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;
constexpr double kPi = 3.14159265358979323846;

SphDef drop(double radius, double tension) {
  SphDef d;
  d.dimension = 2, d.low = {-1, -1, 0}, d.high = {1, 1, 1}, d.spacing = 0.025, d.precision = Precision::f64;
  d.xsph = 0, d.viscosity = 0, d.surface_tension = tension;
  d.bodies = {{.shape = Shape::ball, .radius = radius}};
  return d;
}

/// Second moments: how far a drop reaches along x more than along y, over both.
double flatness(const SphRun& run) {
  double xx = 0, yy = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 x = run.position(i);
    xx += x.x * x.x, yy += x.y * x.y;
  }
  return (xx - yy) / (xx + yy);
}

/// s, period of the second mode of a drop in the plane, from its crossings.
double period(double radius, double tension) {
  SphDef d = drop(radius, tension);
  const double omega = std::sqrt(6 * tension / (d.density * radius * radius * radius));
  // A swing of a tenth of the radius.
  d.bodies[0].strain = {0.1 * omega, -0.1 * omega, 0};
  const double dt = 2 * kPi / omega / 200;
  SphRun run(d, dt);
  double before = 0, crossed[2] = {};
  int count = 0;
  for (int k = 1; k < 400 && count < 2; ++k) {
    run.step();
    const double now = flatness(run);
    if (k > 20 && now * before < 0) crossed[count++] = dt * (k - 1 + before / (before - now));
    before = now;
  }
  // From rest in its shape at t = 0 to the first crossing is half a period.
  return count > 0 ? 2 * crossed[0] : 0;
}

// Rayleigh 1879, in the plane: omega^2 = n (n^2 - 1) sigma / (rho R^3), n = 2.
TEST(SphTension, ADropSwingsAsRayleighSays) {
  for (const double radius : {0.3, 0.5}) {
    const double expected = 2 * kPi / std::sqrt(6 * 10.0 / (1000 * radius * radius * radius));
    EXPECT_NEAR(period(radius, 10), expected, 0.1 * expected) << radius;
  }
  EXPECT_EQ(period(0.3, 1e-9), 0) << "control: without tension it does not come back";
}

// A square drop becomes round: all corners come in, momentum stays.
TEST(SphTension, ASquareGoesRound) {
  SphDef d = drop(0.3, 10);
  d.bodies = {{.shape = Shape::box, .half_extents = {0.3, 0.3, 1}}};
  d.viscosity = 0.01, d.viscosity_step = Viscous::implicit_step;
  SphRun run(d, 0.01);
  const auto farthest = [&] {
    double most = 0;
    for (size_t i = 0; i < run.system.setting().rows; ++i) most = std::max(most, norm(run.position(i)));
    return most;
  };
  const double before = farthest();
  run.seconds(6);
  const double round = 0.6 / std::sqrt(kPi);
  EXPECT_GT(before, 1.15 * round) << "control";
  EXPECT_NEAR(farthest(), round, 1.5 * d.spacing);
  EXPECT_LT(std::abs(run.observe("momentum.x")), 1e-6);
}

}  // namespace
}  // namespace truestep::sph
