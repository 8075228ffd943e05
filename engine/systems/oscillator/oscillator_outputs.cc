// Descriptions of the outputs of the system type "oscillator".
#include "engine/core/outputs.h"
#include "engine/systems/oscillator/oscillator.h"

namespace truestep::oscillator {

const Outputs& oscillator_outputs() {
  static const Outputs kOutputs{
      .rows = "the mass: there is row 0 alone",
      .fields = {{"position", "m", 3, "place; x alone moves"}, {"velocity", "m/s", 3, ""}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all forces that have one"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps whose damping was taken at the step's start"},
          {"error.exact", "m",
           "distance from the exact solution, while no command has disturbed it and nothing drives it"}}};
  return kOutputs;
}

}  // namespace truestep::oscillator
