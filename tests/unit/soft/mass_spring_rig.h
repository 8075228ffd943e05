// A mass_spring system with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::testing_rig {

struct SpringRun {
  explicit SpringRun(const mass_spring::MassSpringDef& def, Vec3 gravity = {0, -9.81, 0}, int threads = 1)
      : system(mass_spring::MassSpring::make(with_integrator(def), {.id = "s", .gravity = gravity})),
        state(system->initial_state()),
        arena(threads) {}

  /// The simplest method unless the test names one.
  static mass_spring::MassSpringDef with_integrator(mass_spring::MassSpringDef def) {
    if (def.integrator.empty()) def.integrator = "symplectic_euler";
    return def;
  }
  std::span<double> x() { return state.f64(mass_spring::MassSpringColumns::position); }
  std::span<double> v() { return state.f64(mass_spring::MassSpringColumns::velocity); }
  Vec3 position(size_t i) { return load3<double>(x().data(), i); }
  Vec3 velocity(size_t i) { return load3<double>(v().data(), i); }

  void step(double h, uint64_t count = 1) {
    for (uint64_t k = 0; k < count; ++k, ++steps) {
      system->step(state, {.t = h * static_cast<double>(steps),
                           .h = h,
                           .step = steps,
                           .workspace = workspace,
                           .arena = arena});
    }
  }
  double observe(std::string_view name) const {
    Observables out;
    system->observe(state, 0, out);
    return out.find(name).value();
  }

  std::unique_ptr<const mass_spring::MassSpring> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  uint64_t steps = 0;
};

}  // namespace truestep::testing_rig
