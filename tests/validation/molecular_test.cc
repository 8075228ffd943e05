// Atoms beside reference numbers: NIST's Lennard-Jones configuration (reference case particles.lj_nist4),
// what the equations of motion conserve, and the pressure of the liquid.
#include <cmath>

#include "tests/support/lj_configuration.h"
#include "tests/unit/molecular_rig.h"

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
  // Control: another cut-off is another energy.
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

/// Largest departure of the total energy over 500 steps of the melted liquid, over the kinetic energy.
double energy_fault(Truncation truncation, double h) {
  MolecularDef d = liquid(5);
  d.truncation = truncation;
  AtomRun run(d, h);
  run.step(static_cast<uint64_t>(1 / h));
  const double start = run.observe("energy.total");
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    run.step(static_cast<uint64_t>(0.1 / h));
    worst = std::max(worst, std::abs(run.observe("energy.total") - start));
  }
  return worst / run.observe("energy.kinetic");
}

TEST(MolecularValidation, EnergyFluctuatesWithTheSquareOfTheStep) {
  // Velocity Verlet: the fluctuation of the energy falls by four when the step is halved; a switched
  // potential has no jumps that would hide it.
  const double coarse = energy_fault(Truncation::switched, 0.004),
               fine = energy_fault(Truncation::switched, 0.002);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.6);
  // Control: a potential that is cut off without a shift jumps whenever a pair crosses the cut-off.
  EXPECT_GT(energy_fault(Truncation::truncated, 0.002), 4 * fine);
}

TEST(MolecularValidation, MomentumStays) {
  AtomRun run(liquid(5), 0.005);
  run.step(500);
  // 500 atoms with speeds of order 1; images differ from their atoms by rounding, some 1e-15 a step.
  for (const char* c : {"momentum.x", "momentum.y", "momentum.z"}) EXPECT_NEAR(run.observe(c), 0, 1e-10);
}

TEST(MolecularValidation, PressureOfTheLiquid) {
  // Johnson, Zollweg, Gubbins 1993: the 32-parameter equation of state and its simulations agree within 1 %
  // of the pressure; see docs/molecular.md for the state and the number.
  MolecularDef d = liquid(5);
  d.temperature = 2.4;
  AtomRun run(d, 0.004);
  run.step(1500);
  double pressure = 0, temperature = 0;
  for (int k = 0; k < 200; ++k) {
    run.step(20);
    pressure += (run.observe("pressure") + run.observe("pressure.tail")) / 200;
    temperature += run.observe("temperature") / 200;
  }
  std::printf("T %.4f P %.4f\n", temperature, pressure);
}

}  // namespace
}  // namespace truestep::molecular
