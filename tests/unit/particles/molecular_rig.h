// Atoms with a state, to be stepped by tests; and the liquid of the usual benchmark in reduced units.
#pragma once
#include <gtest/gtest.h>

#include "engine/systems/molecular/molecular.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct AtomRun : SystemRun<std::unique_ptr<const molecular::Molecular>> {
  explicit AtomRun(const molecular::MolecularDef& def, double dt, int threads = 1, uint64_t seed = 11)
      : SystemRun(
            [&] { return molecular::Molecular::make(def, BuildContext{.id = "s", .dt = dt, .seed = seed}); },
            dt, threads) {}

  /// Accelerations at the state's positions, by a workspace of their own.
  std::vector<double> acceleration() const {
    Workspace fresh;
    Evaluation e{fresh, arena};
    std::vector<double> a(state.f64(0).size());
    system->atoms().acceleration({0, state.f64(0), state.f64(1), state}, a, e);
    return a;
  }
};

/// mass = sigma = epsilon = boltzmann = 1.
inline molecular::MolecularDef reduced() {
  molecular::MolecularDef d;
  molecular::KindDef k;
  k.name = "A", k.mass = k.sigma = k.epsilon = 1;
  d.kinds = {k};
  d.boltzmann = 1, d.cutoff = 2.5, d.skin = 0.3, d.xyz_unit = 1;
  return d;
}
/// 4 n^3 atoms on a face-centred lattice: density 0.8442, temperature 1.44.
inline molecular::MolecularDef liquid(int64_t n) {
  molecular::MolecularDef d = reduced();
  d.lattice.emplace();
  d.lattice->cells = {n, n, n}, d.lattice->number_density = 0.8442;
  d.temperature = 1.44;
  return d;
}

}  // namespace truestep::testing_rig
