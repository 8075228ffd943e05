// An xpbd system with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/xpbd/xpbd.h"

namespace truestep::testing_rig {

struct XpbdRun {
  explicit XpbdRun(const xpbd::XpbdDef& def, double dt = 1.0 / 60, Vec3 gravity = {0, -9.81, 0},
                   int threads = 1)
      : system(std::make_unique<xpbd::Xpbd>(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt})),
        state(system->initial_state()),
        arena(threads),
        h(dt) {}

  Vec3 position(size_t i) const { return load3(state.f64(xpbd::XpbdColumns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(xpbd::XpbdColumns::velocity).data(), i); }
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
    system->observe(state, 0, out);
    return out.find(name).value();
  }
  bool finite() const {
    for (const double x : state.f64(xpbd::XpbdColumns::position)) {
      if (!std::isfinite(x)) return false;
    }
    return true;
  }

  std::unique_ptr<const xpbd::Xpbd> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
