#include "engine/core/equations/force_outputs.h"

namespace truestep {

ForceEnergies force_energies(const ForceSystem& system, const State& state, double t) {
  Workspace workspace;
  static const ThreadArena kSerial(1);
  Evaluation e{workspace, kSerial};
  const ForceField& field = system.force_field();
  const Phase at{t, state.f64(state.at("position")), state.f64(state.at("velocity")), state};
  ForceEnergies out{.kinetic = field.kinetic(at, e)};
  out.potential = field.potential(at, e);
  if (out.potential) out.total = out.kinetic + *out.potential;
  return out;
}

HeldSteps held_steps(const ForceSystem& system, const State& state, double) {
  if (!system.integrator().observe) return {};
  Observables counted;
  system.integrator().observe(state, counted);
  return {counted.find(kHeldStepsRows[0].name)};
}

}  // namespace truestep
