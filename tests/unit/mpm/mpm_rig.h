// A system of the material point method with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>

#include "engine/core/ports/medium.h"
#include "engine/systems/mpm/mpm.h"

namespace truestep::testing_rig {

struct MpmRun {
  explicit MpmRun(const mpm::MpmDef& def, double dt = 1.0 / 60, Vec3 gravity = {}, int threads = 1)
      : system(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt}),
        state(system.initial_state()),
        arena(threads),
        h(dt) {}

  void step(uint64_t count = 1, std::span<ImmersedBody> bodies = {}) {
    for (uint64_t k = 0; k < count; ++k, ++steps) {
      system.step(state, {.t = h * static_cast<double>(steps),
                          .h = h,
                          .step = steps,
                          .workspace = workspace,
                          .arena = arena,
                          .bodies = bodies});
    }
  }
  void seconds(double t) { step(static_cast<uint64_t>(t / h + 0.5)); }
  double observe(std::string_view name) const {
    Observables out;
    system.observe(state, h * static_cast<double>(steps), out);
    return out.find(name).value();
  }
  Vec3 position(size_t i) const { return RealColumn<const double>(state, mpm::columns::position).vector(i); }
  Vec3 velocity(size_t i) const { return RealColumn<const double>(state, mpm::columns::velocity).vector(i); }

  mpm::Mpm system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
