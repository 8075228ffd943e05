// Temperature, pressure, energies, displacement and the radial distribution of a state.
//   T = 2 K / (N_f k),    P = (2 K + W) / (3 V),    W = sum over pairs of r . f
//   g(r) = (neighbours between r and r + dr) / (4/3 pi ((r + dr)^3 - r^3) (N - 1) / V), mean over atoms
#include <cmath>

#include "engine/kernels/molecular/thermostat.h"
#include "engine/systems/molecular/molecular.h"

namespace truestep::molecular {
namespace {

constexpr double kTurn = 6.283185307179586;

/// Tail corrections of energy (J) and pressure (Pa) for atoms beyond the cut-off, assuming they are spread
/// evenly.
LjTail tails(const MolecularField& atoms, double volume) {
  const MolecularDef& d = atoms.def();
  std::vector<double> count(d.kinds.size());
  for (const uint32_t k : atoms.kinds()) count[k] += 1;
  LjTail sum{0, 0};
  for (size_t p = 0; p < count.size(); ++p) {
    for (size_t q = 0; q < count.size(); ++q) {
      const LjTail t = lj_tail(atoms.law().lj(p, q), d.cutoff);
      sum.energy += count[p] * count[q] * t.energy, sum.virial += count[p] * count[q] * t.virial;
    }
  }
  return {kTurn / volume * sum.energy, -kTurn / (3 * volume * volume) * sum.virial};
}

/// J, of a Nose-Hoover thermostat; 0 for others.
double energy_of_chain(const State& s, const MolecularField& atoms) {
  const auto chain = s.f64(Columns::chain);
  if (chain.empty()) return 0;
  const double kt = atoms.def().boltzmann * s.f64(Columns::bath)[static_cast<size_t>(Bath::temperature)];
  const size_t links = chain.size() / 2;
  return chain_energy(chain.first(links), chain.subspan(links),
                      {atoms.freedoms(), kt, atoms.def().thermostat->time});
}

}  // namespace

double Molecular::temperature(double kinetic) const {
  return 2 * kinetic / (atoms_.freedoms() * atoms_.def().boltzmann);
}

double Molecular::within_molecules(const Phase& at, Evaluation& e) const {
  const auto& mass = atoms_.masses();
  std::vector<double> a(at.v.size());
  atoms_.acceleration(at, a, e);
  double sum = 0;
  for (const auto& w : atoms_.start().waters) {
    Vec3 center, mean;
    double total = 0;
    for (const uint32_t i : w) {
      center += load3(at.x.data(), i) * mass[i], mean += load3(at.v.data(), i) * mass[i], total += mass[i];
    }
    for (const uint32_t i : w) {
      const Vec3 u = load3(at.v.data(), i) - mean / total;
      sum += mass[i] * (norm2(u) + dot(load3<double>(a.data(), i), load3(at.x.data(), i) - center / total));
    }
  }
  return sum;
}

void Molecular::observe(const State& s, double t, Observables& out) const {
  Workspace workspace;
  static const ThreadArena kSerial(1);
  Evaluation e{workspace, kSerial};
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity);
  const Phase at{t, x, v, s};
  const double kinetic = atoms_.kinetic(at, e);
  const Energies energies = atoms_.energies(at, e);
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.potential", energies.potential(), "J");
  const MolecularDef& d = atoms_.def();
  out.add("energy.bonds", energies.bonds, "J");
  out.add("energy.total", kinetic + energies.potential(), "J");
  const double heat = s.f64(Columns::bath)[static_cast<size_t>(Bath::heat)];
  out.add("energy.conserved", kinetic + energies.potential() - heat + energy_of_chain(s, atoms_), "J");
  out.add("temperature", temperature(kinetic), "K");
  out.add("virial", energies.virial, "J");
  const Cell cell = atoms_.cell(s);
  if (cell.sides == Sides::periodic) {
    const double volume = cell.volume();
    const LjTail tail = tails(atoms_, volume);
    const double within = d.water ? within_molecules(at, e) : 0;
    out.add("pressure", (2 * kinetic + energies.virial - within) / (3 * volume), "Pa");
    out.add("energy.tail", tail.energy, "J");
    out.add("pressure.tail", tail.virial, "Pa");
    out.add("volume", volume, "m^3");
  }
  Vec3 momentum;
  double displacement = 0;
  const double* start = s.f64(Columns::start).data();
  for (size_t i = 0; i < atoms_.size(); ++i) {
    momentum += load3(v.data(), i) * atoms_.masses()[i];
    displacement += norm2(load3(x.data(), i) - load3(start, i));
  }
  out.add("momentum.x", momentum.x, "kg m/s");
  out.add("momentum.y", momentum.y, "kg m/s");
  out.add("momentum.z", momentum.z, "kg m/s");
  out.add("displacement", displacement / static_cast<double>(atoms_.size()), "m^2");
  if (integrator().observe) integrator().observe(s, out);
}

void Molecular::distribution(const State& s, std::vector<double>& out) const {
  const MolecularDef& d = atoms_.def();
  const Cell cell = atoms_.cell(s);
  const double half = 0.5 * std::min({cell.edges.x, cell.edges.y, cell.edges.z});
  const double range = std::min(d.distribution_range.value_or(d.cutoff), half);
  const size_t n = atoms_.size(), bins = static_cast<size_t>(d.distribution_bins);
  out.assign(bins, 0.0);
  static const ThreadArena kSerial(1);
  NeighbourList list;
  ListSetting setting;
  setting.reach = range;
  setting.kinds.assign(n, 0), setting.charges.assign(n, 0.0);
  list.update(setting, s.f64(Columns::position), cell, kSerial);
  list.place(s.f64(Columns::position).data(), kSerial);
  const double* rows = list.rows().rows;
  const auto place = [&](uint32_t row) { return Vec3{rows[4 * row], rows[4 * row + 1], rows[4 * row + 2]}; };
  for (size_t k = 0; k < list.size(); ++k) {
    const auto entry = list.entry(k);
    for (size_t j = 0; j < entry.count; ++j) {
      const double bin = norm(place(entry.list[j]) - place(entry.row)) / range * static_cast<double>(bins);
      if (bin < static_cast<double>(bins)) out[static_cast<size_t>(bin)] += 1;
    }
  }
  const double width = range / static_cast<double>(bins);
  const double density = static_cast<double>(n > 1 ? n - 1 : 1) / cell.volume();
  for (size_t b = 0; b < bins; ++b) {
    const double r = static_cast<double>(b) * width, to = r + width;
    out[b] /= kTurn * 2 / 3 * (to * to * to - r * r * r) * density * static_cast<double>(n);
  }
}

FieldView Molecular::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  const size_t n = atoms_.size();
  if (part == 1) {
    const size_t bins = static_cast<size_t>(atoms_.def().distribution_bins);
    if (which == 1) {
      distribution(s, scratch);
    } else {
      const Cell cell = atoms_.cell(s);
      const double half = 0.5 * std::min({cell.edges.x, cell.edges.y, cell.edges.z});
      const double range = std::min(atoms_.def().distribution_range.value_or(atoms_.def().cutoff), half);
      scratch.resize(bins);
      for (size_t b = 0; b < bins; ++b) {
        scratch[b] = range * (static_cast<double>(b) + 0.5) / static_cast<double>(bins);
      }
    }
    return {scratch.data(), Scalar::f64, bins, 1};
  }
  if (which == 1) return ForceSystem::field(s, part, which, scratch);
  if (which == 0) {
    const Cell cell = atoms_.cell(s);
    if (cell.sides == Sides::open) return ForceSystem::field(s, part, which, scratch);
    scratch.resize(3 * n);
    const double* x = s.f64(Columns::position).data();
    for (size_t i = 0; i < n; ++i) store3(scratch.data(), i, cell.wrapped(load3(x, i)));
    return {scratch.data(), Scalar::f64, n, 3};
  }
  if (which == 3) {
    scratch.assign(4 * n, 0.0);
    for (size_t i = 0; i < n; ++i) scratch[4 * i] = 1;
    return {scratch.data(), Scalar::f64, n, 4};
  }
  scratch.resize(n);
  const double* v = s.f64(Columns::velocity).data();
  for (size_t i = 0; i < n; ++i) scratch[i] = norm(load3(v, i));
  return {scratch.data(), Scalar::f64, n, 1};
}

}  // namespace truestep::molecular
