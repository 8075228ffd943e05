// A system on its own with a state: build from a definition, step, look. Rigs of one kind of system derive
// from it and add what is particular to them.
#pragma once
#include <cmath>
#include <string>

#include "engine/core/system.h"

namespace truestep::testing_rig {

/// `Held` is the system, or a pointer that owns it.
template <class Held>
struct SystemRun {
  /// `make` returns what is held.
  template <class Make>
  SystemRun(const Make& make, double dt, int threads = 1)
      : system(make()), state(held().initial_state()), arena(threads), h(dt) {}

  const System& held() const {
    if constexpr (requires { *system; }) {
      return *system;
    } else {
      return system;
    }
  }
  double t() const { return h * static_cast<double>(steps); }
  void step(uint64_t count = 1, std::span<ImmersedBody> bodies = {}) {
    for (uint64_t k = 0; k < count; ++k, ++steps) {
      held().step(
          state, {.t = t(), .h = h, .step = steps, .workspace = workspace, .arena = arena, .bodies = bodies});
    }
  }
  void seconds(double s) { step(static_cast<uint64_t>(s / h + 0.5)); }
  double observe(std::string_view name) const {
    Observables out;
    held().observe(state, t(), out);
    return out.find(name).value();
  }
  /// NAN when there is none of that name.
  double observed(const std::string& name) const {
    Observables out;
    held().observe(state, t(), out);
    return out.find(name).value_or(NAN);
  }
  Vec3 observe3(const std::string& name) const {
    return {observe(name + ".x"), observe(name + ".y"), observe(name + ".z")};
  }
  void apply(const Command& c) { held().apply(state, c); }

  Held system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
