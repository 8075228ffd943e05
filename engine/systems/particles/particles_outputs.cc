// Descriptions of the outputs of the system type "particles".
#include "engine/core/outputs.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

const Outputs& particles_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a particle; rows of dead particles are closed up, new ones come at the end (id identifies them)",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"speed", "m/s", 1, "magnitude of the velocity"},
                 {"age", "s", 1, "time since birth"},
                 {"id", "1", 1, "number that is never reused"}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all conservative forces"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps that used the damping of the step's start"},
          {"momentum.x", "kg m/s", "of everything that moves freely"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"count", "1", "present particles"},
          {"emitted", "1", "particles born from emitters and commands"},
          {"killed", "1", "particles removed by planes or age"},
          {"refused", "1", "births refused because max_particles was reached"}}};
  return kOutputs;
}

}  // namespace truestep::particles
