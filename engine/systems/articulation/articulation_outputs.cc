// Descriptions of the outputs of the system type "articulation".
#include "engine/core/outputs.h"
#include "engine/systems/articulation/articulation_def.h"

namespace truestep::articulation {

const Outputs& articulation_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a link in the order of links; of part skeleton the links, then the origins of their joints, which "
          "lines connect",
      .fields = {{"position", "m", 3, "centres of mass; in part skeleton also origins of joints"},
                 {"velocity", "m/s", 3, "of the same"},
                 {"orientation", "1", 4, "unit quaternion w x y z"},
                 {"angular_velocity", "rad/s", 3, "in the world"},
                 {"joint_force", "N", 3, "exerted by the joint on its link, in the world"},
                 {"joint_moment", "N m", 3, "about the joint's origin"}},
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
          {"loops.gap", "m", "largest distance between points that a loop joins"},
          {"power.applied", "W", "if links have a constant force or torque: of those without a potential"}}};
  return kOutputs;
}

}  // namespace truestep::articulation
