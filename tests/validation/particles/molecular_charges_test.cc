// Charges and rigid water: Madelung's constant of rock salt, forces as gradients, what rigid molecules
// conserve, and the equilibrium of a spring under friction and noise.
#include <cmath>

#include "tests/unit/particles/molecular_rig.h"

namespace truestep::molecular {
namespace {

using testing_rig::AtomRun;
using testing_rig::reduced;

/// Rock salt of nearest distance 1 with charges of 1 and no other force.
MolecularDef salt(int64_t n, double accuracy) {
  MolecularDef d = reduced();
  KindDef k;
  k.mass = 1, k.name = "Na", k.charge = 1;
  d.kinds = {k};
  k.name = "Cl", k.charge = -1;
  d.kinds.push_back(k);
  d.lattice.emplace();
  d.lattice->arrangement = LatticeDef::Arrangement::sc, d.lattice->lattice_constant = 1;
  d.lattice->kinds = {"Na", "Cl"}, d.lattice->cells = {n, n, n};
  d.coulomb = Coulomb::ewald, d.coulomb_constant = 1, d.ewald_accuracy = accuracy, d.cutoff = 2;
  d.skin = 0.3;
  return d;
}

TEST(MolecularCharges, MadelungConstantOfRockSalt) {
  constexpr double kMadelung = -1.7475645946331822;
  const auto per_pair = [](const MolecularDef& d) {
    return AtomRun(d, 1e-3).observe("energy.potential") / (0.5 * static_cast<double>(atom_count(d)));
  };
  // Both sums end where their terms are 1e-12 of the first ones, of which there are some thousand.
  EXPECT_NEAR(per_pair(salt(4, 1e-12)), kMadelung, 1e-9);
  EXPECT_NEAR(per_pair(salt(6, 1e-12)), kMadelung, 1e-9);
  // The same through a mesh, to its own accuracy.
  MolecularDef mesh = salt(6, 1e-7);
  mesh.ewald_method = EwaldMethod::mesh;
  EXPECT_NEAR(per_pair(mesh), kMadelung, 1e-6);
  // Control: cut-offs at 1e-4 are not accurate enough for that.
  EXPECT_GT(std::abs(per_pair(salt(4, 1e-4)) - kMadelung), 1e-8);
}

/// Largest departure of m a of the first atoms from differences of the potential.
double force_fault(AtomRun& run, const std::vector<double>& masses) {
  constexpr double kStep = 1e-4;
  const auto a = run.acceleration();
  double* x = run.state.f64(Columns::position).data();
  double worst = 0;
  for (size_t c = 0; c < 9; ++c) {
    const double at = x[c];
    x[c] = at + kStep;
    const double up = run.observe("energy.potential");
    x[c] = at - kStep;
    const double down = run.observe("energy.potential");
    x[c] = at;
    worst = std::max(worst, std::abs(a[c] * masses[c / 3] + (up - down) / (2 * kStep)));
  }
  return worst;
}

TEST(MolecularCharges, ForcesAreGradients) {
  for (const Coulomb method : {Coulomb::ewald, Coulomb::shifted, Coulomb::reaction_field}) {
    MolecularDef d = salt(4, 1e-10);
    d.coulomb = method;
    // Some excluded pairs, and a start that is not a crystal.
    d.bonds = {{.a = 0, .b = 1, .length = 1.2, .stiffness = 3}};
    AtomRun run(d, 1e-3);
    double* x = run.state.f64(Columns::position).data();
    for (size_t k = 0; k < 3 * 64; ++k) x[k] += 0.1 * std::sin(17.0 * static_cast<double>(k));
    std::copy_n(x, 3 * 64, run.state.f64(Columns::reference).data());
    // Third derivatives of some 50, times 1e-8 / 6; rounding 1e-14 x 100 / 2e-4; ends of the sums 1e-10. A
    // pair that crosses the cut-off of the reaction field has a jump of the force, not of the energy.
    EXPECT_LT(force_fault(run, {1, 1, 1}), 2e-6) << static_cast<int>(method);
  }
}

TEST(MolecularCharges, VirialIsTheEnergyOfChargesAlone) {
  // Coulomb's energy is of degree -1: r . f over all images is the energy itself.
  AtomRun run(salt(4, 1e-12), 1e-3);
  EXPECT_NEAR(run.observe("virial"), run.observe("energy.potential"), 1e-7);
}

/// SPC/E (Berendsen, Grigera, Straatsma 1987) in nm, u, ps, so that energies are kJ/mol.
MolecularDef water(int64_t n) {
  MolecularDef d;
  KindDef o, h;
  o.name = "O", o.mass = 15.9994, o.sigma = 0.3166, o.epsilon = 0.650, o.charge = -0.8476;
  h.name = "H", h.mass = 1.008, h.charge = 0.4238;
  d.kinds = {o, h};
  d.water.emplace();
  d.water->cells = {n, n, n}, d.water->spacing = 0.3107, d.water->length = 0.1;
  const double edge = 0.3107 * static_cast<double>(n);
  d.box = Vec3{edge, edge, edge};
  d.boltzmann = 0.00831446261815324, d.coulomb_constant = 138.935457644;
  d.cutoff = 0.45 * edge, d.skin = 0.04 * edge, d.temperature = 300, d.truncation = Truncation::shifted;
  return d;
}

TEST(MolecularCharges, RigidWaterKeepsItsSidesAndItsEnergy) {
  MolecularDef d = water(4);
  d.coulomb = Coulomb::ewald, d.ewald_accuracy = 1e-6;
  d.thermostat.emplace();
  d.thermostat->time = 0.05;
  AtomRun hot(d, 0.001);
  hot.step(1500);
  d.thermostat.reset();
  const auto spread = [&](double h, double& sides) {
    AtomRun run(d, h);
    for (const auto c : {Columns::position, Columns::velocity}) run.state.copy_column(c, hot.state, c);
    const double start = run.observe("energy.total");
    double worst = 0;
    for (int k = 0; k < 20; ++k) {
      run.step(static_cast<uint64_t>(std::llround(0.02 / h)));
      worst = std::max(worst, std::abs(run.observe("energy.total") - start));
    }
    const double* x = run.state.f64(Columns::position).data();
    sides = 0;
    for (size_t i = 0; i < 64; ++i) {
      const Vec3 o = load3(x, 3 * i), a = load3(x, 3 * i + 1), b = load3(x, 3 * i + 2);
      sides = std::max({sides, std::abs(norm(o - a) - 0.1), std::abs(norm(o - b) - 0.1)});
    }
    return worst / run.observe("energy.kinetic");
  };
  double sides = 0;
  const double coarse = spread(0.002, sides);
  EXPECT_LT(sides, 1e-14);
  const double fine = spread(0.001, sides);
  // 2 fs are a tenth of the fastest libration's period: an error of h^2, of 1 % of the kinetic energy.
  EXPECT_LT(coarse, 0.01);
  // Control: half the step has a quarter of that.
  EXPECT_LT(fine, 0.5 * coarse);
}

TEST(MolecularCharges, EnergyOfLiquidWater) {
  // SPC/E at 298 K and 997 kg/m^3: Berendsen et al. 1987 give -41.4 kJ/mol with 5.22 kJ/mol for the work of
  // polarisation, which is -46.6 of potential energy; 216 molecules, Ewald's sum. 6 ps: it fluctuates by 0.35
  // and is not yet quite at rest.
  MolecularDef d = water(6);
  d.coulomb = Coulomb::ewald, d.ewald_accuracy = 1e-4, d.cutoff = 0.85, d.skin = 0.08;
  d.truncation = Truncation::truncated, d.temperature = 298;
  d.thermostat.emplace();
  d.thermostat->temperature = 298, d.thermostat->time = 0.1;
  AtomRun run(d, 0.002);
  run.step(1500);
  double energy = 0, temperature = 0;
  constexpr int kSamples = 50;
  for (int k = 0; k < kSamples; ++k) {
    run.step(10);
    energy += (run.observe("energy.potential") + run.observe("energy.tail")) / 216 / kSamples;
    temperature += run.observe("temperature") / kSamples;
  }
  EXPECT_NEAR(energy, -46.6, 0.8);
  EXPECT_NEAR(temperature, 298, 8);
}

TEST(MolecularCharges, FrictionAndNoiseLeaveASpringItsWidth) {
  // Two atoms on a spring without rest length: <r^2> = 3 kT / k. The scheme's positions are exact in a
  // harmonic well, even at omega h = 1.
  MolecularDef d = reduced();
  d.kinds[0].epsilon = 0, d.kinds[0].sigma = 0;
  d.sides = Sides::open, d.positions = {{0, 0, 0}, {1, 0, 0}};
  d.bonds = {{.a = 0, .b = 1, .length = 0, .stiffness = 2}};
  d.thermostat.emplace();
  d.thermostat->method = ThermostatDef::Method::langevin, d.thermostat->temperature = 1.5,
  d.thermostat->time = 1;
  AtomRun run(d, 0.5);  // omega^2 = 2 k / m = 4
  run.step(100);
  constexpr int kSamples = 40000;
  double sum = 0;
  const double* x = run.state.f64(Columns::position).data();
  for (int k = 0; k < kSamples; ++k) {
    run.step(4);
    sum += norm2(load3(x, 0) - load3(x, 1)) / kSamples;
  }
  // r^2 has a relative spread of sqrt(2/3); samples two relaxation times apart: 0.4 % to 0.7 %, three of
  // these.
  EXPECT_NEAR(sum / (3 * 1.5 / 2), 1, 0.02);
}

}  // namespace
}  // namespace truestep::molecular
