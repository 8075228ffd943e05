// Descriptions of the outputs of the system type "nbody".
#include "engine/systems/nbody/nbody_def.h"

namespace truestep::nbody {

const Outputs& nbody_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a body, first those of positions, then those of groups; rows of bodies that merged into others "
          "are closed up (id identifies them)",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"speed", "m/s", 1, "magnitude of the velocity"},
                 {"mass", "kg", 1, ""},
                 {"id", "1", 1, "row at t = 0"}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of the bodies' attraction, negative"},
          {"energy.total", "J", "their sum"},
          {"momentum.x", "kg m/s", ""},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"center.x", "m", "centre of mass"},
          {"center.y", "m", ""},
          {"center.z", "m", ""},
          {"virial_ratio", "1", "2 K / |W|: 1 in balance, 0 without attraction"},
          {"half_mass_radius", "m", "around the centre of mass"},
          {"count", "1", "present bodies"},
          {"collisions", "1", "collisions so far"},
          {"collisions.left_over", "1", "with collisions: touches for which a step had no room, so far"},
          {"collisions.step_ratio", "1",
           "with collisions and a fixed-step method: the step over the shortest time sqrt(R^3 / "
           "(G m)) of bodies that touched"}}};
  return kOutputs;
}

}  // namespace truestep::nbody
