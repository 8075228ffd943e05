// Thermostats and barostat against the distributions that they should produce.
#include <cmath>

#include "tests/unit/particles/molecular_rig.h"

namespace truestep::molecular {
namespace {

using testing_rig::AtomRun;
using testing_rig::liquid;
using Method = ThermostatDef::Method;

struct Kinetics {
  double mean, variance;  ///< of K, over N_f kT / 2 and N_f (kT)^2 / 2
};

Kinetics kinetics(Method method, double time, double h, int samples, uint64_t between, double freedoms) {
  MolecularDef d = liquid(3);
  d.cutoff = 2.4, d.temperature = 1.2, d.truncation = Truncation::shifted;
  d.thermostat.emplace();
  d.thermostat->method = method, d.thermostat->temperature = 1.2, d.thermostat->time = time;
  AtomRun run(d, h);
  run.step(1000);
  double sum = 0, squares = 0;
  for (int k = 0; k < samples; ++k) {
    run.step(between);
    const double kinetic = run.observe("energy.kinetic") / (0.5 * freedoms * 1.2);
    sum += kinetic / samples, squares += kinetic * kinetic / samples;
  }
  return {sum, (squares - sum * sum) * 0.5 * freedoms};
}

TEST(MolecularBaths, KineticEnergyHasItsMeanAndVariance) {
  // 1000 samples that are several relaxation times apart: the mean of K has a standard error of
  // sqrt(2 / (321 x 1000)) = 0.25 %, the variance one of sqrt(2 / 1000) = 4.5 %; four of each, and h^2.
  constexpr double kH = 0.004;
  const auto holds = [](const Kinetics& k) {
    return std::abs(k.mean - 1) < 0.012 && std::abs(k.variance - 1) < 0.18;
  };
  const Kinetics a = kinetics(Method::velocity_rescaling, 0.05, kH, 1000, 40, 321),
                 b = kinetics(Method::langevin, 0.2, kH, 1000, 60, 324),
                 c = kinetics(Method::nose_hoover, 0.1, kH, 1000, 60, 321);
  EXPECT_TRUE(holds(a)) << a.mean << " " << a.variance;
  EXPECT_TRUE(holds(b)) << b.mean << " " << b.variance;
  EXPECT_TRUE(holds(c)) << c.mean << " " << c.variance;
  // Control: a thermostat so slow that the energy is constant has the variance of constant energy, about
  // half.
  const Kinetics none = kinetics(Method::velocity_rescaling, 1e9, kH, 500, 40, 321);
  EXPECT_LT(none.variance, 0.8);
}

TEST(MolecularBaths, ConservedEnergyStays) {
  for (const Method method : {Method::velocity_rescaling, Method::langevin, Method::nose_hoover}) {
    const auto drift = [&](double h) {
      MolecularDef d = liquid(3);
      d.cutoff = 2.4, d.truncation = Truncation::switched, d.switch_from = 1.8;
      d.thermostat.emplace();
      d.thermostat->method = method, d.thermostat->temperature = 1.2, d.thermostat->time = 0.2;
      AtomRun run(d, h);
      run.step(static_cast<uint64_t>(std::llround(2 / h)));
      const double start = run.observe("energy.conserved");
      run.step(static_cast<uint64_t>(std::llround(8 / h)));
      return std::abs(run.observe("energy.conserved") - start) / 108;
    };
    // A step of 0.002 leaves h^2 of 0.8 (kT per atom) times a few, much less than the energy exchanged.
    EXPECT_LT(drift(0.002), 2e-3) << static_cast<int>(method);
    // Control: four times the step, sixteen times the error.
    EXPECT_GT(drift(0.016), drift(0.002)) << static_cast<int>(method);
  }
}

TEST(MolecularBaths, VolumeOfAnIdealGas) {
  // Atoms without forces, at constant pressure: <V> = N' kT / P with N' = 107 + 1 (momentum is fixed, and the
  // measure dV adds one), and a relative variance of 1 / N'.
  MolecularDef d = liquid(3);
  d.kinds[0].epsilon = 0;
  d.cutoff = 0.5, d.temperature = 1, d.lattice->number_density = 0.5;
  d.thermostat.emplace();
  d.thermostat->temperature = 1, d.thermostat->time = 0.05;
  d.barostat.emplace();
  d.barostat->pressure = 0.5, d.barostat->compressibility = 1, d.barostat->time = 0.2, d.barostat->every = 2;
  AtomRun run(d, 0.01);
  run.step(2000);
  constexpr int kSamples = 4000;
  double sum = 0, squares = 0;
  for (int k = 0; k < kSamples; ++k) {
    run.step(20);
    const double v = run.observe("volume") * 0.5 / 108;
    sum += v / kSamples, squares += v * v / kSamples;
  }
  // Samples are one relaxation time apart, 1000 of them independent: 0.096 / sqrt(1000) = 0.3 % and 4.5 %.
  EXPECT_NEAR(sum, 1, 0.015);
  EXPECT_NEAR((squares - sum * sum) * 108, 1, 0.2);
}

}  // namespace
}  // namespace truestep::molecular
