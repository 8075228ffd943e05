// The melt benchmark of LAMMPS (bench/in.lj): 32,000 Lennard-Jones atoms from a crystal, density 0.8442,
// temperature 1.44, cut-off 2.5, skin 0.3, step 0.005, on one thread; and the same atoms as the particle
// system does it, a sum over cells without lists, as the straightforward peer. The error is the difference of
// their energies of the crystal in the first step: 0 to rounding, both are exact.
#include <cstdio>

#include "engine/neighbours/point_grid.h"
#include "engine/systems/molecular/molecular.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::molecular;
constexpr double kStep = 0.005, kCutoff = 2.5;
constexpr int kSteps = 20, kRounds = 5;

MolecularDef melt() {
  MolecularDef d;
  KindDef k;
  k.name = "A", k.mass = k.sigma = k.epsilon = 1;
  d.kinds = {k};
  d.boltzmann = 1, d.cutoff = kCutoff, d.skin = 0.3, d.temperature = 1.44;
  d.lattice.emplace();
  d.lattice->cells = {20, 20, 20}, d.lattice->number_density = 0.8442;
  return d;
}

/// Velocity Verlet with cells at every step and the nearest image of every pair.
class Cells {
 public:
  Cells(const State& s, const Cell& cell) : cell_(cell) {
    const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity);
    x_.assign(x.begin(), x.end()), v_.assign(v.begin(), v.end()), a_.resize(x.size());
    energy_ = force();
  }
  void step() {
    for (size_t k = 0; k < x_.size(); ++k) v_[k] += 0.5 * kStep * a_[k], x_[k] += kStep * v_[k];
    energy_ = force();
    for (size_t k = 0; k < x_.size(); ++k) v_[k] += 0.5 * kStep * a_[k];
  }
  double energy() const { return energy_; }

 private:
  double force() {
    for (size_t i = 0; i < x_.size() / 3; ++i)
      store3(x_.data(), i, cell_.wrapped(load3<double>(x_.data(), i)));
    grid_.build(x_, kCutoff);
    const LjPair p = mix_lorentz_berthelot(1, 1, 1, 1);
    double energy = 0;
    for (size_t slot = 0; slot < grid_.size(); ++slot) {
      const Vec3 at = grid_.position(slot);
      Vec3 f;
      // Images in which the atom may interact with others.
      for (int image = 0; image < 27; ++image) {
        const Vec3 shift{cell_.edges.x * (image % 3 - 1), cell_.edges.y * (image / 3 % 3 - 1),
                         cell_.edges.z * (image / 9 - 1)};
        const Vec3 here = at + shift, off = here - cell_.low;
        const auto outside = [](double a, double edge) { return a < -kCutoff || a > edge + kCutoff; };
        if (outside(off.x, cell_.edges.x) || outside(off.y, cell_.edges.y) || outside(off.z, cell_.edges.z))
          continue;
        grid_.near(here, [&](size_t begin, size_t end) {
          for (size_t q = begin; q < end; ++q) {
            const Vec3 d = here - grid_.position(q);
            const double r2 = norm2(d);
            if (r2 >= kCutoff * kCutoff || r2 == 0) continue;
            f += d * lj_force_over_r(p, r2), energy += 0.5 * lj_potential(p, r2);
          }
        });
      }
      store3(a_.data(), grid_.point(slot), f);
    }
    return energy;
  }
  Cell cell_;
  std::vector<double> x_, v_, a_;
  PointGrid grid_;
  double energy_;
};

}  // namespace

int main() {
  const auto system = Molecular::make(melt(), {.id = "a", .dt = kStep, .seed = 1});
  State s = system->initial_state();
  Cells cells(s, system->atoms().cell(s));
  Workspace workspace;
  const ThreadArena arena(1);
  uint64_t step = 0;
  const auto ours = [&](int count) {
    for (int k = 0; k < count; ++k, ++step) {
      system->step(s, {.t = static_cast<double>(step) * kStep,
                       .h = kStep,
                       .step = step,
                       .workspace = workspace,
                       .arena = arena});
    }
  };
  ours(1), cells.step();
  Observables out;
  system->observe(s, kStep, out);
  const double fault = std::abs(out.find("energy.potential").value() / cells.energy() - 1);
  const auto times = bench::paired(
      kRounds, [&] { ours(kSteps); },
      [&] {
        for (int k = 0; k < kSteps / 10; ++k) cells.step();
      },
      bench::thread_seconds);
  const double atoms = 32000;
  bench::report({.bench = "molecular",
                 .metric = "atom steps per second",
                 .ours = atoms * kSteps / times.times.ours,
                 .peer = atoms * (kSteps / 10) / times.times.peer,
                 .peer_name = "cells without lists",
                 .better = bench::Comparison::Better::higher,
                 .error_ours = fault,
                 .error_peer = 0.0});
}
