// A system of springs, stepped by the method that it chooses itself.
#pragma once
#include "engine/integrators/implicit/newton/stage_newton.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::testing_rig {

struct OwnMethodRun {
  explicit OwnMethodRun(const mass_spring::MassSpringDef& d, double dt = 1.0 / 60) : h(dt) {
    BuildContext context{.id = "r"};
    context.dt = dt;
    system = mass_spring::MassSpring::make(d, context);
    state = system->initial_state();
  }
  void step() {
    system->step(state,
                 {.t = h * double(done), .h = h, .step = done, .workspace = workspace, .arena = arena});
    ++done;
  }
  double observe(const char* name) const {
    Observables out;
    system->observe(state, 0, out);
    return out.find(name).value();
  }
  const NewtonReport& report() { return workspace.object<NewtonReport>(kNewtonReport); }
  Vec3 tip() const {
    const auto x = state.f64(mass_spring::MassSpringColumns::position);
    return load3(x.data(), x.size() / 3 - 1);
  }

  double h;
  std::unique_ptr<const mass_spring::MassSpring> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t done = 0;
};

}  // namespace truestep::testing_rig
