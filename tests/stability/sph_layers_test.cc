// Liquid that is ten and a hundred times as dense as the one below it: it falls, and neither bursts nor
// crushes the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/systems/sph/solvers/layer_load.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// Two layers, each a third of the box; densities over 1000 kg/m^3.
SphDef two_layers(int dimension, Method solver, Precision precision, double below, double above) {
  SphDef d;
  d.dimension = dimension, d.solver = solver, d.precision = precision;
  // Whole numbers of spacings: a lattice that is pressed together has energy to give.
  d.spacing = dimension == 2 ? 0.04 : 0.05;
  const double deep = dimension == 2 ? 0 : 0.2, thick = dimension == 2 ? 0.16 : 0.15;
  d.high = {0.8, 6 * thick, 2 * deep};
  const Vec3 half{0.4, thick, dimension == 2 ? 0.5 : deep};
  d.bodies = {{.center = {0.4, thick, deep}, .half_extents = half, .density = 1000 * below},
              {.center = {0.4, 3 * thick, deep}, .half_extents = half, .density = 1000 * above}};
  return d;
}

struct Fallen {
  double gain = 0, compression = 0, largest = 0, sunk = 0, substeps = 0;  ///< 1; sunk in m
};
Fallen fallen(const SphDef& d, double seconds) {
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  const double energy = run.observe("energy.total"), height = run.observe("centre.y");
  Fallen out;
  while (static_cast<double>(run.steps) < seconds * 60) {
    run.step();
    out.gain = std::max(out.gain, run.observe("energy.total") / energy - 1);
    out.compression = std::max(out.compression, run.observe("compression.mean"));
    out.largest = std::max(out.largest, run.observe("compression.max"));
    out.substeps = std::max(out.substeps, run.observe("substeps"));
  }
  out.sunk = height - run.observe("centre.y");
  return out;
}

class SphHeavyOverLight : public ::testing::TestWithParam<Method> {};

// dfsph at 30:1 ended with 17 times the density, pbf at 10:1 had a hundred times its energy. Energy grows by
// no more than 1 %, as between equal liquids, and compression is 1 or 2 %, where a pool of one has up to 1;
// single particles that dense liquid falls on in space reach 20 %.
TEST_P(SphHeavyOverLight, FallsAndNeitherBurstsNorCrushes) {
  for (const int dimension : {2, 3}) {
    for (const double heavy : {10.0, 100.0}) {
      for (const Precision precision : {Precision::f32, Precision::f64}) {
        const double seconds = dimension == 2 ? 3 : 1;
        const Fallen f = fallen(two_layers(dimension, GetParam(), precision, 1, heavy), seconds);
        const auto what = [&] { return std::to_string(dimension) + " " + std::to_string(heavy); };
        EXPECT_LT(f.gain, 0.01) << what();
        EXPECT_LT(f.compression, 0.03) << what();
        EXPECT_LT(f.largest, 0.3) << what();
        EXPECT_GT(f.sunk, dimension == 2 ? 0.05 : 0) << what();
      }
    }
  }
}

// The control: light above heavy stays, and needs no shorter substeps than equal liquids.
TEST_P(SphHeavyOverLight, LightOverHeavyStays) {
  const auto of = [&](double below, double above) {
    return fallen(two_layers(2, GetParam(), Precision::f64, below, above), 0.5);
  };
  const Fallen equal = of(1.001, 1), stable = of(100, 1), falling = of(1, 100);
  EXPECT_LT(stable.sunk, 0.01);
  EXPECT_LE(stable.substeps, 2 * equal.substeps);
  EXPECT_GE(falling.substeps, 3 * equal.substeps);
}

// Layers 7.5 spacings thick started with eight in that, and pbf of 100:1 had many times its energy.
TEST_P(SphHeavyOverLight, AnUnevenStartDoesNotBurst) {
  for (const int dimension : {2, 3}) {
    SphDef d = two_layers(dimension, GetParam(), Precision::f32, 1, 100);
    d.spacing = dimension == 2 ? 0.32 / 7.5 : 0.04;
    const Fallen f = fallen(d, dimension == 2 ? 1.5 : 0.5);
    EXPECT_LT(f.gain, 0.01) << dimension;
    EXPECT_LT(f.compression, 0.03) << dimension;
    EXPECT_GT(f.sunk, 0) << dimension;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, SphHeavyOverLight, ::testing::Values(Method::dfsph, Method::pbf),
                         [](const auto& info) { return info.param == Method::dfsph ? "dfsph" : "pbf"; });

// wcsph took its sound from speeds alone: at 100:1 it compressed by a sixth.
TEST(SphHeavyLiquids, HaveASoundThatCarriesThem) {
  const Fallen f = fallen(two_layers(2, Method::wcsph, Precision::f64, 1, 100), 0.5);
  EXPECT_LT(f.gain, 0.01);
  EXPECT_LT(f.compression, 0.01);
  SphDef d = two_layers(2, Method::wcsph, Precision::f64, 1, 100);
  d.sound_speed = 10 * std::sqrt(2 * 9.81 * 0.64);
  EXPECT_GT(fallen(d, 0.5).compression, 0.03) << "control: the sound of one liquid";
}

TEST(SphLayerLoad, IsTheWeightOverTheLightest) {
  const auto load = [](double below, double above) {
    const SphRun run(two_layers(2, Method::pbf, Precision::f64, below, above));
    std::vector<double> scratch;
    return load_by_weight<2>(run.system.setting(), run.state.span<double>(columns::position).data(),
                             run.state.span<double>(run.system.setting().ratio).data(),
                             run.system.setting().rows, {0, -9.81, 0}, scratch);
  };
  // On the lowest layer, all of it; where light is above, on the heavy.
  EXPECT_NEAR(load(1, 10), 9.81 * 0.32 * 11, 1e-9);
  EXPECT_NEAR(load(10, 1), 9.81 * 0.32 * 1.1, 1e-9) << "control: upside down";
}

}  // namespace
}  // namespace truestep::sph
