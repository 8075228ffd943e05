// A body of finite elements with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/fem/fem.h"

namespace truestep::testing_rig {

struct FemRun {
  explicit FemRun(const fem::FemDef& def, double dt = 1.0 / 60, Vec3 gravity = {}, int threads = 1)
      : system(fem::Fem::make(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt})),
        state(system->initial_state()),
        arena(threads),
        h(dt) {}

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
  void step(uint64_t count = 1) {
    for (uint64_t k = 0; k < count; ++k, ++steps) {
      system->step(state, {.t = h * static_cast<double>(steps),
                           .h = h,
                           .step = steps,
                           .workspace = workspace,
                           .arena = arena});
    }
  }
  void seconds(double t) { step(static_cast<uint64_t>(t / h + 0.5)); }
  double observe(std::string_view name) const {
    Observables out;
    system->observe(state, h * static_cast<double>(steps), out);
    return out.find(name).value();
  }

  std::unique_ptr<const fem::Fem> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
