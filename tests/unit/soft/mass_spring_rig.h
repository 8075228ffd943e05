// A mass_spring system with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/mass_spring/mass_spring.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct SpringRun : SystemRun<std::unique_ptr<const mass_spring::MassSpring>> {
  explicit SpringRun(const mass_spring::MassSpringDef& def, Vec3 gravity = {0, -9.81, 0}, int threads = 1)
      : SystemRun(
            [&] {
              return mass_spring::MassSpring::make(with_integrator(def), {.id = "s", .gravity = gravity});
            },
            0, threads) {}

  /// The simplest method unless the test names one.
  static mass_spring::MassSpringDef with_integrator(mass_spring::MassSpringDef def) {
    if (def.integrator.empty()) def.integrator = "symplectic_euler";
    return def;
  }
  std::span<double> x() { return state.f64(mass_spring::MassSpringColumns::position); }
  std::span<double> v() { return state.f64(mass_spring::MassSpringColumns::velocity); }
  Vec3 position(size_t i) { return load3<double>(x().data(), i); }
  Vec3 velocity(size_t i) { return load3<double>(v().data(), i); }

  void step(double dt, uint64_t count = 1) {
    h = dt;
    SystemRun::step(count);
  }
};

}  // namespace truestep::testing_rig
