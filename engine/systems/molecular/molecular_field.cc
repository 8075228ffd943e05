#include "engine/systems/molecular/molecular_field.h"

#include <algorithm>
#include <cmath>

namespace truestep::molecular {
namespace {

/// Fraction of half a skin that a step may use up.
constexpr double kMargin = 0.95;

/// Largest squared distance, over the atoms, of x + h v from the reference positions.
double largest_move2(std::span<const double> x, const double* v, double h, const double* from,
                     const ThreadArena& arena, std::span<double> blocks) {
  const size_t n = x.size() / 3;
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double most = 0;
    for (size_t i = begin; i < end; ++i) {
      Vec3 d = load3(x.data(), i) - load3(from, i);
      if (v) d += load3(v, i) * h;
      const double d2 = norm2(d);
      // A NaN counts as moved.
      most = d2 <= most ? most : d2;
    }
    blocks[begin / kBlockRows] = most;
  });
  double most = 0;
  for (size_t b = 0; b < (n + kBlockRows - 1) / kBlockRows; ++b) most = blocks[b] <= most ? most : blocks[b];
  return most;
}

size_t block_count(size_t rows) {
  return (rows + kBlockRows - 1) / kBlockRows + 1;
}

}  // namespace

MolecularField::MolecularField(const MolecularDef& def, const BuildContext& context)
    : def_(def), start_(make_atoms(def, context.seed)), seed_(context.seed) {
  setting_.reach = def.cutoff + def.skin;
  setting_.kinds = start_.kinds;
  for (const uint32_t k : start_.kinds) {
    setting_.charges.push_back(def.kinds[k].charge);
    masses_.push_back(def.kinds[k].mass), inverse_masses_.push_back(1 / def.kinds[k].mass);
  }
  const bool langevin = def.thermostat && def.thermostat->method == ThermostatDef::Method::langevin;
  const double rigid = 3 * static_cast<double>(start_.waters.size());
  freedoms_ = 3 * static_cast<double>(size()) - rigid - (size() > 1 && !langevin ? 3 : 0);
  excluded_ = excluded_pairs(def, start_);
  if (!excluded_.empty()) setting_.exclusions = exclusions(excluded_, size());
  make_law();
  make_coulomb();
  forces_ = pair_sum_function(law_, Wanted::forces), energies_ = pair_sum_function(law_, Wanted::energies);
}

void MolecularField::make_law() {
  law_.kinds = def_.kinds.size(), law_.truncation = def_.truncation;
  law_.cutoff2 = def_.cutoff * def_.cutoff;
  const double from = def_.switch_from.value_or(0.9 * def_.cutoff);
  law_.from2 = from * from;
  const double least = shortest_distance(def_);
  law_.floor2 = least * least;
  for (const KindDef& p : def_.kinds) {
    for (const KindDef& q : def_.kinds) {
      LjPair pair = mix_lorentz_berthelot(p.sigma, p.epsilon, q.sigma, q.epsilon);
      if (def_.truncation == Truncation::shifted) pair.shift = lj_potential(pair, law_.cutoff2);
      law_.table.insert(law_.table.end(), {pair.c12, pair.c6, pair.shift, 0});
    }
  }
}

void MolecularField::make_coulomb() {
  const auto has_charge = [](const KindDef& k) { return k.charge != 0; };
  if (std::none_of(def_.kinds.begin(), def_.kinds.end(), has_charge)) return;
  const double rc = def_.cutoff;
  law_.coulomb = def_.coulomb_constant, law_.charges = PairLaw::Charges::cutoff;
  if (def_.coulomb == Coulomb::shifted) {
    // The force is 1/r^2 - 1/rc^2.
    law_.b = 1 / (rc * rc), law_.c = -2 / rc;
  } else if (def_.coulomb == Coulomb::reaction_field) {
    const double strength = def_.dielectric ? (*def_.dielectric - 1) / (2 * *def_.dielectric + 1) : 0.5;
    law_.a = strength / (rc * rc * rc), law_.c = -1 / rc - law_.a * rc * rc;
  } else if (def_.coulomb == Coulomb::ewald) {
    law_.charges = PairLaw::Charges::ewald;
    ewald_ = ewald_setting(def_.coulomb_constant, rc, def_.ewald_accuracy);
    law_.alpha = ewald_.alpha;
    if (by_mesh(def_)) mesh_ = mesh_setting(ewald_, start_.cell.edges, def_.ewald_accuracy);
    // The series is accurate well beyond the sums' cut-offs.
    law_.erf = ErfSeries(1.001 * law_.alpha * law_.alpha * law_.cutoff2,
                         std::max(2e-16, 1e-7 * def_.ewald_accuracy));
  }
}

State MolecularField::initial_state() const {
  State s;
  const size_t n = size();
  s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  s.add({"neighbours.reference", "m", Scalar::f64, 3}, n);
  s.add({"start", "m", Scalar::f64, 3}, n);
  s.add({"box", "m", Scalar::f64, 3}, 1);
  s.add({"bath", "SI"}, static_cast<size_t>(Bath::count));
  const bool chain = def_.thermostat && def_.thermostat->method == ThermostatDef::Method::nose_hoover;
  s.add({"thermostat.chain", "SI"}, chain ? 2 * static_cast<size_t>(def_.thermostat->chain) : 0);
  const auto bath = s.f64(Columns::bath);
  if (def_.thermostat) bath[static_cast<size_t>(Bath::temperature)] = def_.thermostat->temperature;
  if (def_.barostat) bath[static_cast<size_t>(Bath::pressure)] = def_.barostat->pressure;
  for (size_t i = 0; i < n; ++i) {
    for (const auto c : {Columns::position, Columns::reference, Columns::start}) {
      store3(s.f64(c).data(), i, start_.positions[i]);
    }
    store3(s.f64(Columns::velocity).data(), i, start_.velocities[i]);
  }
  store3(s.f64(Columns::box).data(), 0, start_.cell.edges);
  return s;
}

Cell MolecularField::cell(const State& state) const {
  if (def_.sides == Sides::open) return {};
  // A box of another size keeps its centre.
  const Vec3 edges = load3(state.f64(Columns::box).data(), 0);
  return {Sides::periodic, start_.cell.low + (start_.cell.edges - edges) * 0.5, edges};
}

const NeighbourList& MolecularField::list(const Phase& at, Evaluation& e) const {
  const auto reference = at.state.f64(Columns::reference);
  const auto blocks = e.workspace.doubles("molecular.blocks", block_count(size()));
  // The barostat needs them in later steps, too.
  e.workspace.doubles("molecular.energies", 2 * (size() / NeighbourList::kBlock + 1));
  const double moved = largest_move2(at.x, nullptr, 0, reference.data(), e.arena, blocks);
  const bool near = moved <= 0.25 * def_.skin * def_.skin;
  auto& list = e.workspace.object<NeighbourList>(near ? "molecular.list" : "molecular.stage_list");
  list.update(setting_, near ? reference : at.x, cell(at.state), e.arena);
  list.place(at.x.data(), e.arena);
  return list;
}

void MolecularField::renew_reference(State& s, double h, const ThreadArena& arena,
                                     Workspace& workspace) const {
  const auto x = s.f64(Columns::position);
  const auto blocks = workspace.doubles("molecular.blocks", block_count(size()));
  const double moved =
      largest_move2(x, s.f64(Columns::velocity).data(), h, s.f64(Columns::reference).data(), arena, blocks);
  const double most = 0.5 * kMargin * def_.skin;
  if (!(moved <= most * most)) std::copy(x.begin(), x.end(), s.f64(Columns::reference).begin());
}

bool MolecularField::has_more() const {
  return !def_.bonds.empty() || !def_.angles.empty() || !def_.dihedrals.empty() || ewald_.alpha > 0;
}

void MolecularField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  const NeighbourList& near = list(at, e);
  const PairRows rows = near.rows();
  std::fill(a.begin(), a.end(), 0.0);
  e.arena.for_blocks(near.size(), NeighbourList::kBlock, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const auto entry = near.entry(k);
      const Vec3 f = forces_(law_, rows, entry.row, entry.list, entry.count).force;
      store3(a.data(), entry.atom, f * inverse_masses_[entry.atom]);
    }
  });
  if (!has_more()) return;
  const auto force = e.workspace.doubles("molecular.force", 3 * size()).first(3 * size());
  std::fill(force.begin(), force.end(), 0.0);
  const Cell box = cell(at.state);
  add_bonds(at, box, force);
  add_waves(at, box, force, e);
  for (size_t i = 0; i < size(); ++i) {
    store3(a.data(), i, load3<double>(a.data(), i) + load3<double>(force.data(), i) * inverse_masses_[i]);
  }
}

Energies MolecularField::energies(const Phase& at, Evaluation& e) const {
  const NeighbourList& near = list(at, e);
  const PairRows rows = near.rows();
  const size_t blocks = (near.size() + NeighbourList::kBlock - 1) / NeighbourList::kBlock;
  const auto sums = e.workspace.doubles("molecular.energies", 2 * blocks);
  e.arena.for_blocks(near.size(), NeighbourList::kBlock, [&](size_t begin, size_t end) {
    double energy = 0, virial = 0;
    for (size_t k = begin; k < end; ++k) {
      const auto entry = near.entry(k);
      const PairSum sum = energies_(law_, rows, entry.row, entry.list, entry.count);
      energy += sum.energy, virial += sum.virial;
    }
    sums[2 * (begin / NeighbourList::kBlock)] = energy;
    sums[2 * (begin / NeighbourList::kBlock) + 1] = virial;
  });
  Energies out;
  for (size_t b = 0; b < blocks; ++b) out.pairs += sums[2 * b], out.virial += sums[2 * b + 1];
  if (!has_more()) return out;
  const Cell box = cell(at.state);
  const Energies bonds = add_bonds(at, box, {}), waves = add_waves(at, box, {}, e);
  out.bonds = bonds.bonds, out.waves = waves.waves, out.virial += bonds.virial + waves.virial;
  return out;
}

std::optional<double> MolecularField::potential(const Phase& at, Evaluation& e) const {
  return energies(at, e).potential();
}

double MolecularField::kinetic(const Phase& at, Evaluation& e) const {
  return e.arena.sum_blocks(size(), kBlockRows, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += 0.5 * masses_[i] * norm2(load3(at.v.data(), i));
    return sum;
  });
}

std::optional<ForceField::Stiffness> MolecularField::stiffness(const State&) const {
  double omega2 = 0;
  for (const KindDef& k : def_.kinds) {
    if (k.sigma > 0) omega2 = std::max(omega2, 8 * 57.15 * k.epsilon / (k.sigma * k.sigma * k.mass));
  }
  for (const BondDef& b : def_.bonds) {
    const double light =
        inverse_masses_[static_cast<size_t>(b.a)] + inverse_masses_[static_cast<size_t>(b.b)];
    omega2 = std::max(omega2, 2 * b.stiffness * light);
  }
  return Stiffness{std::sqrt(omega2), 0};
}

}  // namespace truestep::molecular
