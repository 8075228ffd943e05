// Descriptions of the outputs of the system type "mass_spring".
#include "engine/core/outputs.h"
#include "engine/systems/mass_spring/mass_spring_def.h"

namespace truestep::mass_spring {

const Outputs& mass_spring_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a point: along a rope from its first end, strand by strand in hair, j nx + i in a cloth grid, in "
          "the given order in a mesh or free network",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"force", "N", 3, "sum of all forces on the point; 0 where it is pinned"},
                 {"strain", "1", 1, "largest |length / rest length - 1| of its springs"},
                 {"reaction", "N", 3, "force of the pin on the point; 0 where it is free"},
                 {"springs.strain", "1", 1, "of part springs, one row per spring: length / rest length - 1"}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all conservative forces"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps that used the damping of the step's start"},
          {"momentum.x", "kg m/s", "of all free points"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"strain.max", "1", "largest |length / rest length - 1| of structural springs"},
          {"strain.rms", "1", "root mean square of the same"},
          {"pins", "1", "points that are pinned"},
          {"reaction.x", "N", "sum of the forces of the pins on the points"},
          {"reaction.y", "N", ""},
          {"reaction.z", "N", ""}}};
  return kOutputs;
}

}  // namespace truestep::mass_spring
