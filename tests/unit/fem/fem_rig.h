// A body of finite elements with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/fem/fem.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct FemRun : SystemRun<std::unique_ptr<const fem::Fem>> {
  explicit FemRun(const fem::FemDef& def, double dt = 1.0 / 60, Vec3 gravity = {}, int threads = 1)
      : SystemRun([&] { return fem::Fem::make(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt}); },
                  dt, threads) {}

  Vec3 position(size_t i) const { return load3(state.f64(fem::FemColumns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(fem::FemColumns::velocity).data(), i); }
  Vec3 displacement(size_t i) const { return position(i) - system->body().mesh.x[i]; }
  /// The node nearest to a place at rest.
  size_t node_at(const Vec3& place) const {
    size_t best = 0;
    const auto& x = system->body().mesh.x;
    for (size_t i = 0; i < x.size(); ++i) {
      if (norm(x[i] - place) < norm(x[best] - place)) best = i;
    }
    return best;
  }
  Vec3 displacement_at(const Vec3& place) const { return displacement(node_at(place)); }
};

}  // namespace truestep::testing_rig
