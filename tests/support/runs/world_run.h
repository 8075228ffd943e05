// A scene on its own, from its text: step, look, command. Tests whose scenes need parts of their own inherit
// it.
#pragma once
#include <cmath>
#include <string>

#include "engine/session/world/world.h"

namespace truestep::testing_rig {

struct WorldRun {
  explicit WorldRun(const std::string& scene, int threads = 1)
      : world(parse_scene(scene)), state(world.initial_state()), arena(threads) {}
  WorldRun& steps(int n) {
    for (int k = 0; k < n; ++k) world.step(state, workspace, arena, {});
    return *this;
  }
  /// Of the scene, or of its first system; NAN when there is none.
  double observed(const std::string& name) const {
    const Observables all = world.observe(state);
    return all.find(name).value_or(all.find(world.id(0) + '.' + name).value_or(NAN));
  }
  State& s() { return state.systems[0]; }
  const State& s() const { return state.systems[0]; }
  void apply(const Command& c) { world.system(0).apply(s(), c); }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena;
};

}  // namespace truestep::testing_rig
