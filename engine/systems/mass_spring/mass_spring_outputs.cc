// Descriptions of the outputs of the system type "mass_spring".
#include "engine/core/outputs.h"
#include "engine/systems/mass_spring/mass_spring_def.h"

namespace truestep::mass_spring {

const Outputs& mass_spring_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a point: along a rope from its first end, strand by strand of hair, j nx + i of a cloth grid, in "
          "the order given of a mesh or free points",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"force", "N", 3, "sum of all forces on the point; 0 where it is held"},
                 {"strain", "1", 1, "largest |length / rest length - 1| of its springs"},
                 {"reaction", "N", 3, "force by which a pin holds the point; 0 where it is free"},
                 {"springs.strain", "1", 1, "of part springs, a row per spring: length / rest length - 1"}},
      .observables = {
          {"energy.kinetic", "J", "of motion"},
          {"energy.potential", "J", "of all forces that have one"},
          {"energy.total", "J", "their sum"},
          {"integrator.held_steps", "1", "implicit_euler: steps whose damping was taken at the step's start"},
          {"momentum.x", "kg m/s", "of all that moves freely"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"strain.max", "1", "largest |length / rest length - 1| of structural springs"},
          {"strain.rms", "1", "root of the mean square of the same"},
          {"pins", "1", "points that are held"},
          {"reaction.x", "N", "sum of the forces by which the pins hold the points"},
          {"reaction.y", "N", ""},
          {"reaction.z", "N", ""}}};
  return kOutputs;
}

}  // namespace truestep::mass_spring
