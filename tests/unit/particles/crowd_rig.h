// A crowd with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include "engine/systems/crowd/crowd.h"

namespace truestep::testing_rig {

struct CrowdRun {
  explicit CrowdRun(const crowd::CrowdDef& def, double dt = 1.0 / 60, int threads = 1, uint64_t seed = 11)
      : system(def, BuildContext{.id = "s", .dt = dt, .seed = seed}),
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
  size_t people() const { return state.rows(crowd::Columns::position); }
  Vec3 position(size_t i) const { return load3(state.f64(crowd::Columns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(crowd::Columns::velocity).data(), i); }
  double observe(std::string_view name) const {
    Observables out;
    system.observe(state, h * static_cast<double>(steps), out);
    return out.find(name).value();
  }

  crowd::Crowd system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

/// A person at `from` who makes for `to`.
inline crowd::GroupDef walker(const Vec3& from, const Vec3& to) {
  crowd::GroupDef g;
  g.positions = {from}, g.goals = {to};
  return g;
}

}  // namespace truestep::testing_rig
