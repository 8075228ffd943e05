// A flock with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include "engine/systems/flocking/flocking.h"

namespace truestep::testing_rig {

struct FlockRun {
  explicit FlockRun(const flocking::FlockingDef& def, double dt, int threads = 1)
      : system(def, BuildContext{.id = "s", .dt = dt, .seed = 11}),
        state(system.initial_state()),
        arena(threads),
        h(dt) {}

  void step(uint64_t count = 1) {
    for (uint64_t k = 0; k < count; ++k, ++steps) {
      system.step(state, {.t = h * static_cast<double>(steps),
                          .h = h,
                          .step = steps,
                          .workspace = workspace,
                          .arena = arena});
    }
  }
  Vec3 position(size_t i) const { return load3(state.f64(flocking::Columns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(flocking::Columns::velocity).data(), i); }
  double observe(std::string_view name) const {
    Observables out;
    system.observe(state, h * static_cast<double>(steps), out);
    return out.find(name).value();
  }

  flocking::Flocking system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
