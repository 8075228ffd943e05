// Kernels of atoms and molecules: potentials against their derivatives, erf against the C library's, four
// lanes against one, rigid triangles against their invariants, texts against their errors.
#include <gmock/gmock.h>

#include <cmath>

#include "engine/kernels/molecular/bonded.h"
#include "engine/kernels/molecular/near_rows.h"
#include "engine/kernels/molecular/settle.h"
#include "engine/systems/molecular/xyz.h"
#include "tests/unit/particles/molecular_rig.h"

namespace truestep::molecular {
namespace {

using testing_rig::AtomRun;
using testing_rig::reduced;

TEST(MolecularKernels, SwitchedPotentialAndItsSlope) {
  for (const double r2 : {1.0, 4.0, 4.5, 5.5, 6.2, 6.3}) {
    constexpr double kStep = 1e-6;
    const Switch s = lj_switch(r2, 4, 6.25);
    const double slope =
        (lj_switch(r2 + kStep, 4, 6.25).value - lj_switch(r2 - kStep, 4, 6.25).value) / (2 * kStep);
    // Differences of 1e-16 over 2e-6, and a curvature that jumps at the ends.
    EXPECT_NEAR(s.slope, slope, 1e-6);
  }
  EXPECT_EQ(lj_switch(4, 4, 6.25).value, 1);
  EXPECT_EQ(lj_switch(6.25, 4, 6.25).value, 0);
}

TEST(MolecularKernels, ErfSeries) {
  const ErfSeries series(25);
  for (double u = 0.01; u < 25; u += 0.07) {
    const double z = std::sqrt(u), e = std::erf(z) / z;
    const double g = std::erf(z) / (z * u) - 2 / std::sqrt(M_PI) * std::exp(-u) / u;
    // Sums of 40 terms of at most 1.13: some 1e-15; the expected g loses digits to cancelling below u = 1.
    EXPECT_NEAR(series.at(u).e, e, 4e-15) << u;
    EXPECT_NEAR(series.at(u).g, g, 4e-15 + 1e-15 / u) << u;
    EXPECT_NEAR(ErfSeries::exact(u).e, e, 1e-14) << u;
  }
}

/// Largest deviation of forces from differences of the energy of four points.
template <class Energy, class Forces>
double fault(std::array<Vec3, 4> x, const Energy& energy, const Forces& forces) {
  constexpr double kStep = 1e-5;
  const auto f = forces(x);
  double worst = 0;
  for (size_t i = 0; i < 4; ++i) {
    for (double Vec3::*c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      auto up = x, down = x;
      up[i].*c += kStep, down[i].*c -= kStep;
      worst = std::max(worst, std::abs(f[i].*c + (energy(up) - energy(down)) / (2 * kStep)));
    }
  }
  return worst;
}

TEST(MolecularKernels, BondedForcesAreGradients) {
  using X = std::array<Vec3, 4>;
  const X x{Vec3{0.1, 0.2, -0.3}, Vec3{1.0, 0.1, 0.2}, Vec3{1.3, 1.2, 0.4}, Vec3{2.1, 1.1, 1.3}};
  const auto bonds = [](const X& p) {
    const BondForce f = bond(p[0] - p[1], 3, 0.7);
    return std::pair(f.energy, X{f.on_a, -f.on_a, {}, {}});
  };
  const auto angles = [](const X& p) {
    const AngleForce f = angle(p[0] - p[1], p[2] - p[1], 3, 1.2);
    return std::pair(f.energy, X{f.on_a, -(f.on_a + f.on_c), f.on_c, {}});
  };
  const auto dihedrals = [](const X& p) {
    const DihedralForce f = dihedral(p[0] - p[1], p[1] - p[2], p[3] - p[2], 3, 2, 0.4);
    return std::pair(f.energy, X{f.on_a, f.on_b, f.on_c, f.on_d});
  };
  // Differences over 2e-5 of energies of order 1: 1e-10 from h^2 and 1e-11 from rounding.
  const auto check = [&](const auto& law) {
    return fault(
        x, [&](const X& p) { return law(p).first; }, [&](const X& p) { return law(p).second; });
  };
  EXPECT_LT(check(bonds), 2e-9);
  EXPECT_LT(check(angles), 2e-9);
  EXPECT_LT(check(dihedrals), 2e-9);
  // Control: the forces of another multiplicity do not belong to this energy.
  EXPECT_GT(
      fault(
          x, [&](const X& p) { return dihedral(p[0] - p[1], p[1] - p[2], p[3] - p[2], 3, 3, 0.4).energy; },
          [&](const X& p) { return dihedrals(p).second; }),
      0.1);
}

TEST(MolecularKernels, BondedForcesAreFiniteWhereNothingIsDefined) {
  EXPECT_EQ(norm(bond({}, 3, 1).on_a), 0);
  EXPECT_EQ(norm(angle({1, 0, 0}, {-2, 0, 0}, 3, 1).on_a), 0);
  EXPECT_EQ(norm(angle({}, {1, 0, 0}, 3, 1).on_c), 0);
  EXPECT_EQ(norm(dihedral({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3, 1, 0).on_b), 0);
}

TEST(MolecularKernels, DihedralOfTransIsPi) {
  // cis: phi = 0, trans: phi = pi; k (1 + cos phi) is 2 k and 0.
  const Vec3 axis{-1, 0, 0};
  EXPECT_NEAR(dihedral({0, 1, 0}, axis, {0, 1, 0}, 1, 1, 0).energy, 2, 1e-15);
  EXPECT_NEAR(dihedral({0, 1, 0}, axis, {0, -1, 0}, 1, 1, 0).energy, 0, 1e-15);
}

TEST(MolecularKernels, SettleKeepsSidesMomentumAndAngularMomentum) {
  const WaterShape w{15.9994, 1.008, 0.1, 0.16329931618554522};
  const Vec3 o{0.3, -0.2, 0.5}, down = normalized(Vec3{1, 2, -0.5}),
                                side = normalized(cross(down, Vec3{0, 0, 1}));
  const Triangle old{o, o + down * w.height() + side * (0.5 * w.hh),
                     o + down * w.height() - side * (0.5 * w.hh)};
  const Triangle moved{old[0] + Vec3{0.01, 0.002, -0.004}, old[1] + Vec3{-0.012, 0.007, 0.003},
                       old[2] + Vec3{0.004, -0.011, 0.009}};
  const Triangle put = settle_places(w, old, moved);
  const double mass[3] = {w.oxygen, w.hydrogen, w.hydrogen};
  const auto side_of = [&](const Triangle& t, int i, int j) { return norm(t[i] - t[j]); };
  // Lengths of 0.1 made of sums of numbers of order 1.
  EXPECT_NEAR(side_of(put, 0, 1), w.oh, 1e-15);
  EXPECT_NEAR(side_of(put, 0, 2), w.oh, 1e-15);
  EXPECT_NEAR(side_of(put, 1, 2), w.hh, 1e-15);
  Vec3 momentum, spin;
  for (int i = 0; i < 3; ++i) {
    const Vec3 change = (put[i] - moved[i]) * mass[i];
    momentum += change, spin += cross(old[i], change);
  }
  // Forces along the old sides have no momentum and no moment.
  EXPECT_LT(norm(momentum), 1e-14);
  EXPECT_LT(norm(spin), 1e-14);
  // Control: the step itself did change the sides.
  EXPECT_GT(std::abs(side_of(moved, 0, 1) - w.oh), 1e-3);

  const Triangle v = settle_velocities(w, put, {Vec3{1, 2, 3}, Vec3{-2, 0.5, 1}, Vec3{0.3, -1, -2}});
  for (const auto& [i, j] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    EXPECT_NEAR(dot(v[i] - v[j], put[i] - put[j]), 0, 1e-14);
  }
  EXPECT_NEAR(v[0].x * w.oxygen + (v[1].x + v[2].x) * w.hydrogen, w.oxygen - 1.7 * w.hydrogen, 1e-13);
}

TEST(MolecularKernels, NearRowsAreThoseWithinReach) {
  std::vector<double> x, y, z;
  for (int i = 0; i < 103; ++i) x.push_back(0.01 * i), y.push_back(0.003 * i * i), z.push_back(std::sin(i));
  const PlaceColumns p{x.data(), y.data(), z.data()};
  for (const size_t to : {96, 97, 98, 99, 100}) {
    std::vector<uint32_t> list(110), expected;
    const size_t n = append_near(p, 5, to, {0.5, 1, 0}, 1.3, list.data(), 0);
    list.resize(n);
    for (uint32_t k = 5; k < to; ++k) {
      if (norm2(Vec3{x[k] - 0.5, y[k] - 1, z[k]}) < 1.3) expected.push_back(k);
    }
    EXPECT_EQ(list, expected);
    EXPECT_GT(n, 5u);
  }
}

TEST(MolecularXyz, SaysInWhichLine) {
  const XyzAtoms atoms = read_xyz("2\r\nwater\r\nO 0 +1.5 -2e0 extra\r\n  H\t1 2 3\r\n");
  EXPECT_EQ(atoms.names, (std::vector<std::string>{"O", "H"}));
  EXPECT_EQ(atoms.positions[0], (Vec3{0, 1.5, -2}));
  const auto line = [](const char* text) -> size_t {
    try {
      read_xyz(text);
    } catch (const XyzFault& f) {
      return f.line;
    }
    return 0;
  };
  EXPECT_EQ(line(""), 1u);
  EXPECT_EQ(line("x\n"), 1u);
  EXPECT_EQ(line("-1\n"), 1u);
  EXPECT_EQ(line("0\n"), 1u);
  EXPECT_EQ(line("99999999999999999999\n"), 1u);
  EXPECT_EQ(line("2\n\nA 0 0 0\n"), 4u);
  EXPECT_EQ(line("1\n\nA 0 0\n"), 3u);
  EXPECT_EQ(line("1\n\nA 0 0 nan\n"), 3u);
  EXPECT_EQ(line("1\n\n\n"), 3u);
}

TEST(Molecular, TwoKindsMix) {
  // Two atoms at 1.3: energy and force of sigma (1 + 1.4) / 2, epsilon sqrt(1 x 0.25).
  MolecularDef d = reduced();
  KindDef other = d.kinds[0];
  other.name = "B", other.sigma = 1.4, other.epsilon = 0.25, other.mass = 2;
  d.kinds.push_back(other);
  d.sides = Sides::open, d.positions = {{0, 0, 0}, {1.3, 0, 0}}, d.position_kinds = {"A", "B"};
  AtomRun run(d, 0.01);
  const double s6 = std::pow(1.2 / 1.3, 6);
  EXPECT_NEAR(run.observe("energy.potential"), 4 * 0.5 * (s6 * s6 - s6), 1e-14);
  const auto a = run.acceleration();
  const double force = 4 * 0.5 * (12 * s6 * s6 - 6 * s6) / 1.3;
  EXPECT_NEAR(a[0], -force, 1e-13);
  EXPECT_NEAR(a[3], force / 2, 1e-13);
}

TEST(Molecular, CoincidentAtomsHaveAForce) {
  MolecularDef d = reduced();
  d.sides = Sides::open, d.positions = {{0, 0, 0}, {1, 0, 0}};
  AtomRun run(d, 0.01);
  double* x = run.state.f64(Columns::position).data();
  x[3] = 0;
  EXPECT_EQ(run.acceleration()[0], 0);
  x[3] = 1e-5;
  EXPECT_TRUE(std::isfinite(run.acceleration()[0]));
  EXPECT_LT(run.acceleration()[0], 0);
}

/// Values of a field of part "distribution".
std::vector<double> distribution(const AtomRun& run, size_t field) {
  std::vector<double> scratch;
  const FieldView v = run.system->field(run.state, 1, field, scratch);
  const auto* p = static_cast<const double*>(v.data);
  return {p, p + v.rows};
}

TEST(Molecular, DistributionOfACrystal) {
  // Face-centred cubic of constant a: 12 neighbours at a / sqrt(2), 6 at a, 24 at a sqrt(3/2).
  MolecularDef d = testing_rig::liquid(4);
  const double a = std::cbrt(4 / 0.8442);
  d.distribution_bins = 250;
  const AtomRun run(d, 0.005);
  const auto r = distribution(run, 0), g = distribution(run, 1);
  const auto count = [&](double at) {
    double sum = 0;
    for (size_t b = 0; b < r.size(); ++b) {
      const double half = 0.005, low = r[b] - half, high = r[b] + half;
      const double shell = 4 * M_PI / 3 * (std::pow(high, 3) - std::pow(low, 3));
      if (std::abs(r[b] - at) < 0.02) sum += g[b] * shell * 0.8442 * 255 / 256;
    }
    return sum;
  };
  EXPECT_NEAR(count(a / std::sqrt(2)), 12, 1e-9);
  EXPECT_NEAR(count(a), 6, 1e-9);
  EXPECT_NEAR(count(a * std::sqrt(1.5)), 24, 1e-9);
  EXPECT_EQ(count(1.1 * a), 0);
}

TEST(Molecular, DisplacementCountsThroughTheSides) {
  MolecularDef d = testing_rig::liquid(4);
  d.kinds[0].epsilon = 0, d.temperature = 0;
  AtomRun run(d, 0.01);
  double* v = run.state.f64(Columns::velocity).data();
  for (size_t i = 0; i < 256; ++i) v[3 * i] = 30;
  run.step(100);
  // 30 in every component: four boxes further.
  EXPECT_NEAR(run.observe("displacement"), 900, 1e-9);
  std::vector<double> scratch;
  const FieldView x = run.system->field(run.state, 0, 0, scratch);
  const double edge = 0.5 * std::cbrt(256 / 0.8442);
  for (size_t k = 0; k < 768; ++k)
    EXPECT_LE(std::abs(static_cast<const double*>(x.data)[k]), edge * (1 + 1e-12));
}

TEST(Molecular, TakesItsBathsByCommand) {
  MolecularDef d = testing_rig::liquid(4);
  d.thermostat.emplace();
  AtomRun run(d, 0.005);
  Command c{.kind = CommandKind::set_parameter, .system = "s"};
  c.name = "temperature", c.value = 2;
  run.system->apply(run.state, c);
  EXPECT_EQ(run.state.f64(Columns::bath)[0], 2);
  c.value = 0;
  EXPECT_THROW(run.system->apply(run.state, c), Error);
  c.value = 1, c.name = "pressure";
  EXPECT_THROW(run.system->apply(run.state, c), Error);
  c.kind = CommandKind::push;
  EXPECT_THROW(run.system->apply(run.state, c), Error);
}

/// Pointers of what is wrong with a def.
std::vector<std::string> faults(const MolecularDef& d) {
  std::vector<std::string> out;
  molecular_table().check(&d,
                          [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

TEST(Molecular, RefusesWhatCannotBe) {
  using ::testing::ElementsAre;
  using ::testing::IsEmpty;
  EXPECT_THAT(faults(testing_rig::liquid(4)), IsEmpty());
  const auto changed = [](const auto& change) {
    MolecularDef d = testing_rig::liquid(4);
    change(d);
    return faults(d);
  };
  EXPECT_THAT(changed([](auto& d) { d.cutoff = 3.4; }), ElementsAre("/box"));
  EXPECT_THAT(changed([](auto& d) { d.lattice->cells = {2, 4, 4}; }), ElementsAre("/box"));
  EXPECT_THAT(changed([](auto& d) { d.lattice->lattice_constant = 1; }), ElementsAre("/lattice"));
  EXPECT_THAT(changed([](auto& d) { d.lattice->kinds = {"B"}; }), ElementsAre("/lattice/kinds/0"));
  EXPECT_THAT(changed([](auto& d) { d.lattice.reset(); }), ElementsAre(""));
  EXPECT_THAT(changed([](auto& d) { d.xyz = "1\n\nB 0 0 0\n"; }), ElementsAre("/xyz"));
  EXPECT_THAT(changed([](auto& d) { d.xyz = "2\n\nA 0 0 0\n"; }), ElementsAre("/xyz"));
  EXPECT_THAT(changed([](auto& d) { d.positions = {{0.1, 0, 0}, {0.1, 0, 0}}; }), ElementsAre("/positions"));
  EXPECT_THAT(changed([](auto& d) { d.bonds = {{.a = 0, .b = 256}}; }), ElementsAre("/bonds/0"));
  EXPECT_THAT(changed([](auto& d) { d.bonds = {{.a = 3, .b = 3}}; }), ElementsAre("/bonds/0"));
  EXPECT_THAT(changed([](auto& d) { d.barostat.emplace(); }), ElementsAre("/barostat"));
  EXPECT_THAT(changed([](auto& d) { d.switch_from = 2.0; }), ElementsAre("/switch_from"));
  EXPECT_THAT(changed([](auto& d) { d.dielectric = 2.0; }), ElementsAre("/dielectric"));
  EXPECT_THAT(changed([](auto& d) { d.coulomb = Coulomb::ewald, d.sides = Sides::open; }),
              ElementsAre("/coulomb"));
}

TEST(Molecular, BondsLeaveOutFirstAndSecondNeighbours) {
  // A chain of five: pairs three and four bonds apart have a force.
  MolecularDef d = reduced();
  d.sides = Sides::open, d.cutoff = 10;
  for (int i = 0; i < 5; ++i) d.positions.push_back({1.1 * i, 0, 0});
  for (int i = 0; i < 4; ++i) d.bonds.push_back({.a = i, .b = i + 1, .length = 1.1, .stiffness = 5});
  const LjPair p = mix_lorentz_berthelot(1, 1, 1, 1);
  const double expected = 2 * lj_potential(p, 3.3 * 3.3) + lj_potential(p, 4.4 * 4.4);
  EXPECT_NEAR(AtomRun(d, 0.01).observe("energy.potential"), expected, 1e-14);
}

}  // namespace
}  // namespace truestep::molecular
