// A system of springs, stepped by the method that it chooses itself.
#pragma once
#include "engine/integrators/implicit/newton/stage_newton.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct OwnMethodRun : SystemRun<std::unique_ptr<const mass_spring::MassSpring>> {
  explicit OwnMethodRun(const mass_spring::MassSpringDef& d, double dt = 1.0 / 60)
      : SystemRun([&] { return mass_spring::MassSpring::make(d, BuildContext{.id = "r", .dt = dt}); }, dt) {}
  const NewtonReport& report() { return workspace.object<NewtonReport>(kNewtonReport); }
  Vec3 tip() const {
    const auto x = state.f64(mass_spring::MassSpringColumns::position);
    return load3(x.data(), x.size() / 3 - 1);
  }
};

}  // namespace truestep::testing_rig
