// Descriptions of the outputs of the system type "pendulum".
#include "engine/core/outputs.h"
#include "engine/systems/pendulum/pendulum.h"

namespace truestep::pendulum {

const Outputs& pendulum_outputs() {
  static const Outputs kOutputs{
      .rows = "the pivot (0) and the masses (1 ...); in part joints the links (0 ...)",
      .fields = {{"position", "m", 3, "of pivot and masses"},
                 {"velocity", "m/s", 3, ""},
                 {"angle", "rad", 1, "of a link from the downward vertical"},
                 {"angular_velocity", "rad/s", 1, ""}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all conservative forces"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps that used the damping of the step's start"}}};
  return kOutputs;
}

}  // namespace truestep::pendulum
