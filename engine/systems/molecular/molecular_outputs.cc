// What molecules give out: temperature, pressure, energies, displacement and the radial distribution.
//   T = 2 K / (N_f k),    P = (2 K + W) / (3 V),    W = sum over pairs of r . f
//   g(r) = (neighbours between r and r + dr) / (4/3 pi ((r + dr)^3 - r^3) (N - 1) / V), mean over atoms
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
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

struct Molecular::Whole {
  using Maybe = std::optional<double>;
  double kinetic = 0, potential = 0, bonds = 0, conserved = 0, temperature = 0, virial = 0, displacement = 0;
  Vec3 momentum;
  Maybe energy_tail, pressure, pressure_tail, volume;  ///< of a periodic box
  double energy() const { return kinetic + potential; }
};

const OutputTable& Molecular::outputs() {
  using M = Molecular;
  using W = Whole;
  using C = Columns;
  static const OutputTable kTable =
      OutputsOf<M>("an atom: positions first, then xyz, lattice, water (O H H)")
          .part("", [](const M& m) { return points_part(m.atoms_.size()); })
          .field(
              {"position", "m", Scalar::f64, 3, Meaning::position},
              [](const M& m, const State& s, const FieldAt& at) {
                const bool open = m.atoms_.cell(s).sides == Sides::open;
                return open ? column(C::position)(s, at) : computed_by<M>(&M::wrap)(m, s, at);
              },
              "within the box")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"speed", "m/s"}, length_of(C::velocity), "magnitude of the velocity")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation},
                 computed([](const State&, ShownRows rows, double* out) {
                   for (size_t i = 0; i < 4 * rows.count; ++i) out[i] = i % 4 == 0 ? 1 : 0;
                 }),
                 "1 0 0 0, if kinds are drawn in their own sizes or colours")
          .field_when([](const M& m) { return m.atoms_.def().has_looks(); })
          .part("distribution",
                [](const M& m) {
                  const MolecularDef& d = m.atoms_.def();
                  const bool periodic = d.sides == Sides::periodic;
                  const auto bins = static_cast<size_t>(d.distribution_bins);
                  return periodic ? std::optional(values_part(bins)) : std::nullopt;
                })
          .field({"distribution.distance", "m"}, computed_by<M>(&M::distances),
                 "of part distribution, in a periodic box: mean radius of a shell")
          .field({"distribution.density", "1"}, computed_by<M>(&M::distribution),
                 "g(r): density around an atom over the mean density")
          .measured(
              &M::whole,
              {{"energy.kinetic", "J", &W::kinetic},
               {"energy.potential", "J", &W::potential,
                "of pairs within the cut-off, molecules and Ewald's sum"},
               {"energy.bonds", "J", &W::bonds, "part of energy.potential: bonds, angles, dihedrals"},
               {"energy.total", "J", &W::energy},
               {"energy.conserved", "J", &W::conserved,
                "energy.total minus the thermostat's input; with nose_hoover plus that of its chain"},
               {"energy.tail", "J", &W::energy_tail, "beyond the cut-off, for an even distribution"},
               {"temperature", "K", &W::temperature},
               {"virial", "J", &W::virial, "sum over pairs of r . f"},
               {"pressure", "Pa", &W::pressure,
                "(2 energy.kinetic + virial) / 3 V, of a periodic box; for rigid molecules with those of "
                "their centres"},
               {"pressure.tail", "Pa", &W::pressure_tail, "as energy.tail"},
               {"volume", "m^3", &W::volume, "of a periodic box"},
               {"momentum", "kg m/s", &W::momentum},
               {"displacement", "m^2", &W::displacement, "mean square since the start"}})
          .build();
  return kTable;
}

const Outputs& molecular_outputs() {
  static const Outputs kDescribed = Molecular::outputs().described();
  return kDescribed;
}

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

Molecular::Whole Molecular::whole(const State& s, double t) const {
  Workspace workspace;
  static const ThreadArena kSerial(1);
  Evaluation e{workspace, kSerial};
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity);
  const Phase at{t, x, v, s};
  const MolecularDef& d = atoms_.def();
  Whole out;
  out.kinetic = atoms_.kinetic(at, e);
  const Energies energies = atoms_.energies(at, e);
  out.potential = energies.potential(), out.bonds = energies.bonds, out.virial = energies.virial;
  const double heat = s.f64(Columns::bath)[static_cast<size_t>(Bath::heat)];
  out.conserved = out.energy() - heat + energy_of_chain(s, atoms_);
  out.temperature = temperature(out.kinetic);
  const Cell cell = atoms_.cell(s);
  if (cell.sides == Sides::periodic) {
    const double volume = cell.volume();
    const LjTail tail = tails(atoms_, volume);
    const double within = d.water ? within_molecules(at, e) : 0;
    out.pressure = (2 * out.kinetic + energies.virial - within) / (3 * volume);
    out.energy_tail = tail.energy, out.pressure_tail = tail.virial, out.volume = volume;
  }
  double displacement = 0;
  const double* start = s.f64(Columns::start).data();
  for (size_t i = 0; i < atoms_.size(); ++i) {
    out.momentum += load3(v.data(), i) * atoms_.masses()[i];
    displacement += norm2(load3(x.data(), i) - load3(start, i));
  }
  out.displacement = displacement / static_cast<double>(atoms_.size());
  return out;
}

double Molecular::range(const State& s) const {
  const Vec3 edges = atoms_.cell(s).edges;
  return std::min(atoms_.def().distribution_range.value_or(atoms_.def().cutoff),
                  0.5 * std::min({edges.x, edges.y, edges.z}));
}

void Molecular::wrap(const State& s, ShownRows rows, double* out) const {
  const Cell cell = atoms_.cell(s);
  const double* x = s.f64(Columns::position).data();
  for (size_t i = 0; i < rows.count; ++i) store3(out, i, cell.wrapped(load3(x, i)));
}

void Molecular::distances(const State& s, ShownRows bins, double* out) const {
  const double range = this->range(s);
  for (size_t b = 0; b < bins.count; ++b)
    out[b] = range * (static_cast<double>(b) + 0.5) / static_cast<double>(bins.count);
}

void Molecular::distribution(const State& s, ShownRows shells, double* out) const {
  const Cell cell = atoms_.cell(s);
  const double range = this->range(s);
  const size_t n = atoms_.size(), bins = shells.count;
  std::fill_n(out, bins, 0.0);
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

}  // namespace truestep::molecular
