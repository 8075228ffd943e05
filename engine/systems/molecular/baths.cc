// Thermostats and barostats (kernels/molecular/thermostat.h). Random numbers are functions of seed, row and
// step.
#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/errors.h"
#include "engine/kernels/molecular/thermostat.h"
#include "engine/systems/molecular/molecular.h"

namespace truestep::molecular {
namespace {

/// Streams of random numbers; those below kRows belong to the whole system.
enum Stream : uint64_t { kStart, kRescaling, kBox, kRows };

double bath(const State& s, Bath which) {
  return s.f64(Columns::bath)[static_cast<size_t>(which)];
}

}  // namespace

double Molecular::kinetic(const State& s, const StepInput& in) const {
  Evaluation e{in.workspace, in.arena};
  return atoms_.kinetic({in.t, s.f64(Columns::position), s.f64(Columns::velocity), s}, e);
}

void Molecular::scale_velocities(State& s, double factor, const ThreadArena& arena) const {
  double* v = s.f64(Columns::velocity).data();
  arena.for_blocks(3 * atoms_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) v[k] *= factor;
  });
}

void Molecular::rescale(State& s, const StepInput& in) const {
  const double before = kinetic(s, in), kt = atoms_.def().boltzmann * bath(s, Bath::temperature);
  const double factor = rescaling_factor(before, atoms_.freedoms(), kt, in.h / atoms_.def().thermostat->time,
                                         {atoms_.seed(), kRescaling, in.step});
  scale_velocities(s, factor, in.arena);
  s.f64(Columns::bath)[static_cast<size_t>(Bath::heat)] += (factor * factor - 1) * before;
}

void Molecular::half_chain(State& s, const StepInput& in) const {
  const double kt = atoms_.def().boltzmann * bath(s, Bath::temperature);
  const auto all = s.f64(Columns::chain);
  const size_t links = all.size() / 2;
  const double factor =
      chain_half_step({all.first(links), all.subspan(links)},
                      {atoms_.freedoms(), kt, atoms_.def().thermostat->time}, kinetic(s, in), in.h);
  scale_velocities(s, factor, in.arena);
}

double Molecular::add_noise(Motion& m) const {
  const double c = trig::exp(-m.input.h / atoms_.def().thermostat->time);
  const double kt = atoms_.def().boltzmann * bath(m.state, Bath::temperature),
               gain = std::sqrt((1 - c * c) * kt);
  const double* inverse_mass = atoms_.inverse_mass(m.state).data();
  double* v = m.v.data();
  const auto block = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) {
      const Vec3 u = load3<double>(v, i);
      const Vec3 w =
          u * c + normal3(atoms_.seed(), kRows + i, m.input.step) * (gain * std::sqrt(inverse_mass[i]));
      sum += 0.5 / inverse_mass[i] * (norm2(w) - norm2(u));
      store3(v, i, w);
    }
    return sum;
  };
  return m.input.arena.sum_blocks(atoms_.size(), kBlockRows, std::ref(block));
}

void Molecular::change_box(State& s, const StepInput& in) const {
  const MolecularDef& d = atoms_.def();
  const BarostatDef& b = *d.barostat;
  const auto every = static_cast<uint64_t>(b.every);
  if (in.step % every != every - 1) return;
  Evaluation e{in.workspace, in.arena};
  const auto x = s.f64(Columns::position);
  const Cell cell = atoms_.cell(s);
  const double volume = cell.volume(), kt = d.boltzmann * bath(s, Bath::temperature);
  const double twice = 2 * kinetic(s, in);
  const double pressure =
      (twice + atoms_.energies({in.t, x, s.f64(Columns::velocity), s}, e).virial) / (3 * volume);
  const double r = normal4(atoms_.seed(), kBox, in.step)[0];
  const double change = cell_rescaling(pressure, bath(s, Bath::pressure), volume, kt,
                                       b.compressibility / b.time, in.h * static_cast<double>(b.every), r);
  const double factor = trig::exp(change / 3);
  const Vec3 edges = cell.edges * factor, center = cell.low + cell.edges * 0.5;
  if (!(std::min({edges.x, edges.y, edges.z}) >= 2 * d.cutoff)) {
    throw Instability("", "box", -1, "the pressure would make the box smaller than two cut-offs");
  }
  store3(s.f64(Columns::box).data(), 0, edges);
  for (const auto column : {Columns::position, Columns::start}) {
    double* p = s.f64(column).data();
    for (size_t i = 0; i < atoms_.size(); ++i) store3(p, i, center + (load3<double>(p, i) - center) * factor);
  }
  std::copy(x.begin(), x.end(), s.f64(Columns::reference).begin());
  scale_velocities(s, 1 / factor, in.arena);
}

}  // namespace truestep::molecular
