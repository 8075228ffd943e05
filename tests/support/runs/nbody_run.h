// Bodies with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "engine/systems/nbody/nbody.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct NbodyRun : SystemRun<std::unique_ptr<const nbody::Nbody>> {
  explicit NbodyRun(const nbody::NbodyDef& def, double dt, int threads = 1)
      : SystemRun([&] { return nbody::Nbody::make(def, BuildContext{.id = "n", .dt = dt, .seed = 5}); }, dt,
                  threads) {}

  size_t count() const { return state.rows(nbody::Columns::position); }
  Vec3 x(size_t i) const { return load3(state.f64(nbody::Columns::position).data(), i); }
  Vec3 v(size_t i) const { return load3(state.f64(nbody::Columns::velocity).data(), i); }
};

/// Model units: G = 1.
inline nbody::NbodyDef model_units() {
  nbody::NbodyDef d;
  d.gravitational_constant = 1;
  return d;
}

/// The quasi-random Plummer sphere of the reference cases nbody.plfib_1024 and nbody.plfib_4096: G = M = a
/// = 1.
inline nbody::NbodyDef spiral_plummer(size_t n) {
  nbody::NbodyDef d = model_units();
  const double golden = 0.5 * (1 + std::sqrt(5.0)) - 1, turn = 6.283185307179586;
  for (size_t i = 0; i < n; ++i) {
    const double m = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    const double r = 1 / std::sqrt(std::pow(m, -2.0 / 3) - 1);
    double corput = 0, digit = 0.5;
    for (size_t k = i + 1; k > 0; k >>= 1, digit *= 0.5) corput += (k & 1) ? digit : 0;
    const double z = 2 * corput - 1, share = static_cast<double>(i) * golden;
    const double phi = turn * (share - std::floor(share)), s = std::sqrt(1 - z * z);
    d.positions.push_back(Vec3{s * std::cos(phi), s * std::sin(phi), z} * r);
  }
  d.mass = 1 / static_cast<double>(n);
  return d;
}

}  // namespace truestep::testing_rig
