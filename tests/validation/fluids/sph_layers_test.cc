// Two liquids of different density by particles: layers at rest, and the growth of a wave between them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// A tank of two layers, `heavy` times as dense below.
SphDef layers(double heavy, Precision precision) {
  SphDef d;
  d.dimension = 2, d.high = {0.6, 1, 1}, d.spacing = 0.025, d.precision = precision;
  d.bodies = {{.center = {0.3, 0.15, 0}, .half_extents = {0.3, 0.15, 1}, .density = 1000 * heavy},
              {.center = {0.3, 0.45, 0}, .half_extents = {0.3, 0.15, 1}}};
  return d;
}

double rms_speed(const SphRun& run) {
  return std::sqrt(2 * run.observe("energy.kinetic") / run.observe("mass"));
}

/// Least squares: a quantity of particles in 0.08 <= y <= 0.22 (m) over height (per m).
template <class Quantity>
double slope_over_height(const SphRun& run, const Quantity& quantity) {
  double n = 0, y = 0, yy = 0, q = 0, yq = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 at = run.position(i);
    if (at.y < 0.08 || at.y > 0.22) continue;
    const double value = quantity(i);
    n += 1, y += at.y, yy += at.y * at.y, q += value, yq += at.y * value;
  }
  return (n * yq - y * q) / (n * yy - y * y);
}

// Heavy below light stays so: speeds under 1 % of sqrt(g H), as in a pool of one liquid, and in the heavy
// layer pressure that grows by its weight. How rows come to rest hangs on the last bit: slopes of starts that
// are a millionth of a metre apart differ by 0.5 %, and the mean over three and both precisions is compared.
// The solve's own pressures would be 5 % too steep.
TEST(SphLayers, ATankOfTwoLayersRests) {
  for (const double heavy : {2.0, 10.0, 100.0}) {
    constexpr int kStarts = 3, kSamples = 5;
    double slope = 0;
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      for (int start = 0; start < kStarts; ++start) {
        SphRun run(layers(heavy, precision), 1.0 / 60, {0, -9.81, 0});
        run.shake(1e-6, static_cast<uint64_t>(start));
        run.seconds(5);
        EXPECT_LT(rms_speed(run), 0.01 * std::sqrt(9.81 * 0.6)) << heavy;
        for (int k = 0; k < kSamples; ++k) {
          run.step(6);
          const std::vector<double> p = run.pressures();
          slope += slope_over_height(run, [&](size_t i) { return p[i]; }) / (2 * kStarts * kSamples);
        }
        // Nothing has mixed: the heavy layer's particles are below the light one's, to within a spacing.
        double highest = 0, lowest = 1;
        const size_t half = run.system.setting().rows / 2;
        for (size_t i = 0; i < half; ++i) highest = std::max(highest, run.position(i).y);
        for (size_t i = half; i < 2 * half; ++i) lowest = std::min(lowest, run.position(i).y);
        EXPECT_LT(highest - lowest, 0.025) << heavy;
      }
    }
    // Case fluid.hydrostatic's 2 %. Control: the light layer's weight would be at most half of it.
    EXPECT_NEAR(slope, -9810 * heavy, 0.02 * 9810 * heavy) << heavy;
  }
}

// The control of the above: upside down it does not stay, and the horizontal momentum is zero.
TEST(SphLayers, HeavyAboveLightFalls) {
  SphDef d = layers(10, Precision::f64);
  std::swap(d.bodies[0].density, d.bodies[1].density);
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  const double before = run.observe("centre.y");
  // Within 3 s.
  while (run.steps < 180 && run.observe("centre.y") >= before - 0.1) run.step();
  EXPECT_LT(run.observe("centre.y"), before - 0.1);
}

// Case fluid.rayleigh_taylor: inviscid growth sqrt(A g k) of a small wave with A = 1/3, k = 2 pi. The tank is
// half a wave wide, half a wave deep on both sides (which takes 0.2 % off the rate), and full, with a lid.
// The amplitude is that of the interface's first mode, by the particles' moments. A sheared lattice sums to a
// different density than one at rest, and pressure resists that like a stiffness: by 37 % of the rate with
// wendland_c2 of three spacings, whatever the resolution. Wide kernels do not see the lattice.
double growth(double density, Smoothing kernel, double support, double spacing) {
  constexpr double kSigma = 4.532771332692313;
  SphDef d;
  constexpr double kDepth = 0.5;
  d.dimension = 2, d.low = {0, -kDepth, 0}, d.high = {0.5, kDepth, 1}, d.spacing = spacing;
  d.precision = Precision::f64, d.kernel = kernel, d.support = support;
  d.density_error = 1e-5, d.xsph = 0, d.viscosity = 0;
  d.bodies = {{.center = {0.25, -kDepth / 2, 0}, .half_extents = {0.25, kDepth / 2, 1}},
              {.center = {0.25, kDepth / 2, 0}, .half_extents = {0.25, kDepth / 2, 1}, .density = density}};
  SphRun run(d, 0.005, {0, -9.81, 0});
  // Started from the linear theory's velocities with the border still flat: amplitude grows by sinh.
  constexpr double kStart = 0.04, kK = 2 * std::numbers::pi;
  RealColumn<double> v(run.state, columns::velocity);
  const size_t n = run.system.setting().rows;
  for (size_t i = 0; i < n; ++i) {
    const Vec3 x = run.position(i);
    const double fade = std::sinh(kK * (kDepth - std::abs(x.y))) / std::sinh(kK * kDepth);
    const double along =
        std::cosh(kK * (kDepth - std::abs(x.y))) / std::sinh(kK * kDepth) * (x.y > 0 ? 1 : -1);
    v.set_vector(i, Vec3{std::sin(kK * x.x) * along, std::cos(kK * x.x) * fade, 0} * kStart);
  }
  // The first mode of the vertical displacement of particles that start within a tenth of the interface.
  std::vector<std::pair<size_t, Vec3>> near;
  for (size_t i = 0; i < n; ++i) {
    if (std::abs(run.position(i).y) < 0.05) near.push_back({i, run.position(i)});
  }
  const auto amplitude = [&] {
    double out = 0, norm = 0;
    for (const auto& [i, start] : near) {
      const double mode = std::cos(kK * start.x);
      out += (run.position(i).y - start.y) * mode, norm += mode * mode;
    }
    return out / norm;
  };
  // sinh(s t2) / sinh(s t1) for t2 = 2 t1 is 2 cosh(s t1).
  run.seconds(0.25);
  const double first = amplitude();
  run.seconds(0.25);
  const double ratio = amplitude() / first;
  const double rate = std::acosh(std::max(ratio / 2, 1.0)) / 0.25;
  return rate / kSigma;
}

TEST(SphLayers, AWaveBetweenLayersGrows) {
  // The case's tolerance.
  EXPECT_NEAR(growth(2000, Smoothing::wendland_c4, 4, 0.0125), 1, 0.1);
  // At twice the spacing, where this wave grows at 0.92 of the rate.
  EXPECT_LT(growth(1100, Smoothing::wendland_c4, 4, 0.025), 0.5) << "control: an Atwood number of 1/21";
  EXPECT_LT(growth(2000, Smoothing::wendland_c2, 3, 0.025), 0.9) << "control: a kernel that sees the lattice";
}

}  // namespace
}  // namespace truestep::sph
