// Atoms against reference numbers: NIST's Lennard-Jones configuration (reference case particles.lj_nist4),
// what the equations of motion conserve, and the pressure of the liquid.
#include <cmath>

#include "tests/support/lj_configuration.h"
#include "tests/unit/particles/molecular_rig.h"

namespace truestep::molecular {
namespace {

using testing_rig::AtomRun;
using testing_rig::liquid;
using testing_rig::reduced;

MolecularDef configuration4(double cutoff) {
  MolecularDef d = reduced();
  d.xyz = testing::kLjConfiguration4, d.box = Vec3{8, 8, 8}, d.cutoff = cutoff;
  return d;
}

TEST(MolecularValidation, NistConfigurationFour) {
  AtomRun run(configuration4(3), 1e-3);
  // 30 x 29 / 2 pairs summed in another order than the source's: some 1e-15 each.
  const auto close = [](double value, double expected) {
    EXPECT_NEAR(value, expected, 1e-13 * std::abs(expected));
  };
  close(run.observe("energy.potential"), -16.790321304625856);
  close(run.observe("virial"), -46.24919674630891);  // r . f, the source has r dU/dr
  close(run.observe("energy.tail"), -0.5451660014945704);
  const auto a = run.acceleration();
  close(a[0], 3.2550996788935804), close(a[1], 0.46779911807152147), close(a[2], 0.6261231507660318);
  double most = 0;
  for (const double c : a) most = std::max(most, std::abs(c));
  close(most, 7.173862237072643);
  // Control: another cut-off gives another energy.
  EXPECT_GT(std::abs(AtomRun(configuration4(3.01), 1e-3).observe("energy.potential") + 16.790321304625856),
            1e-3);
}

TEST(MolecularValidation, NistConfigurationFourFromAnywhere) {
  // Images by whole boxes, a list with a wider skin, and threads change nothing but rounding.
  MolecularDef d = configuration4(3);
  d.skin = 1;
  AtomRun run(d, 1e-3, 3);
  double* x = run.state.f64(Columns::position).data();
  double* reference = run.state.f64(Columns::reference).data();
  for (size_t i = 0; i < 30; ++i) {
    const Vec3 by{8.0 * static_cast<double>(i % 3), -8.0 * static_cast<double>(i % 4), 16};
    store3(x, i, load3<double>(x, i) + by), store3(reference, i, load3<double>(x, i));
  }
  EXPECT_NEAR(run.observe("energy.potential"), -16.790321304625856, 1e-12);
}

/// Root mean square of the total energy about its mean, over 4 units of time of the melted liquid.
double energy_spread(Truncation truncation, double h) {
  MolecularDef d = liquid(4);
  d.truncation = truncation, d.cutoff = 2.5;
  if (truncation == Truncation::switched) d.switch_from = 1.8;
  AtomRun run(d, h);
  run.step(static_cast<uint64_t>(std::llround(1 / h)));
  double sum = 0, squares = 0;
  constexpr int kSamples = 200;
  const double start = run.observe("energy.total");
  for (int k = 0; k < kSamples; ++k) {
    run.step(static_cast<uint64_t>(std::llround(0.02 / h)));
    const double e = run.observe("energy.total") - start;
    sum += e / kSamples, squares += e * e / kSamples;
  }
  return std::sqrt(squares - sum * sum);
}

TEST(MolecularValidation, EnergyFluctuatesWithTheSquareOfTheStep) {
  // Velocity Verlet conserves an energy that differs by terms of h^2, so that halving the step leaves a
  // quarter. 200 correlated samples of two different trajectories: some 15 % each, 0.4 in the exponent.
  const double coarse = energy_spread(Truncation::switched, 0.004),
               fine = energy_spread(Truncation::switched, 0.002);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.5);
  // Control: a potential that is cut off without a shift jumps whenever a pair crosses the cut-off.
  EXPECT_GT(energy_spread(Truncation::truncated, 0.002), 10 * fine);
}

TEST(MolecularValidation, MomentumStays) {
  AtomRun run(liquid(5), 0.005);
  run.step(500);
  // 500 atoms with speeds of order 1; images differ from their atoms by rounding, some 1e-15 a step.
  for (const char* c : {"momentum.x", "momentum.y", "momentum.z"}) EXPECT_NEAR(run.observe(c), 0, 1e-10);
}

TEST(MolecularValidation, EnergyAndPressureOfTheLiquid) {
  // NIST Standard Reference Simulation Website, Lennard-Jones fluid, Monte Carlo, cut-off 3 with tails, 500
  // atoms: at T = 0.85 and density 0.82 U/N = -5.7947 +- 0.0005, p = 0.55355 +- 0.003.
  MolecularDef d = liquid(5);
  d.lattice->number_density = 0.82, d.cutoff = 3, d.temperature = 1.7;
  d.thermostat.emplace();
  d.thermostat->temperature = 0.85, d.thermostat->time = 0.2;
  AtomRun run(d, 0.004);
  run.step(3000);
  constexpr int kSamples = 1000;
  double pressure = 0, energy = 0, temperature = 0, bare = 0;
  for (int k = 0; k < kSamples; ++k) {
    run.step(10);
    pressure += (run.observe("pressure") + run.observe("pressure.tail")) / kSamples;
    bare += run.observe("pressure") / kSamples;
    energy += (run.observe("energy.potential") + run.observe("energy.tail")) / 500 / kSamples;
    temperature += run.observe("temperature") / kSamples;
  }
  // Standard deviations of a sample are 0.3 (pressure), 0.03 (energy) and 0.03 (temperature), the samples,
  // 0.04 apart, correlated over some five: 1000 / 5 of them leave 0.02, 0.002 and 0.002; three of these, and
  // the step's own h^2 (0.1 % of the temperature).
  EXPECT_NEAR(temperature, 0.85, 0.006);
  EXPECT_NEAR(energy, -5.7947, 0.008);
  EXPECT_NEAR(pressure, 0.55355, 0.06);
  // Control: without the tail the pressure is different.
  EXPECT_GT(std::abs(bare - 0.55355), 0.1);
}

}  // namespace
}  // namespace truestep::molecular
