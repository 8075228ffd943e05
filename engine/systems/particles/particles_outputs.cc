// Descriptions of the outputs of the system type "particles".
#include "engine/core/outputs.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

const Outputs& particles_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a particle; rows of particles that die are closed up, new ones come at the end (id tells them "
          "apart)",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"speed", "m/s", 1, "magnitude of the velocity"},
                 {"age", "s", 1, "time since birth"},
                 {"id", "1", 1, "number that is never used twice"}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all forces that have one"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps whose damping was taken at the step's start"},
          {"momentum.x", "kg m/s", "of all that moves freely"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"count", "1", "particles that there are"},
          {"emitted", "1", "particles born from emitters and commands"},
          {"killed", "1", "particles removed by planes or age"},
          {"refused", "1", "births that the most particles allowed left no room for"}}};
  return kOutputs;
}

}  // namespace truestep::particles
