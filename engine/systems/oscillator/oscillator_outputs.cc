// Descriptions of the outputs of the system type "oscillator".
#include "engine/core/outputs.h"
#include "engine/systems/oscillator/oscillator.h"

namespace truestep::oscillator {

const Outputs& oscillator_outputs() {
  static const Outputs kOutputs{
      .rows = "the mass: only row 0",
      .fields = {{"position", "m", 3, "only x changes"}, {"velocity", "m/s", 3, ""}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all conservative forces"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps that used the damping of the step's start"},
          {"error.exact", "m",
           "difference from the exact solution, until a command disturbs it and while it is not driven"}}};
  return kOutputs;
}

}  // namespace truestep::oscillator
