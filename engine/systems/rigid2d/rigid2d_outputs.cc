// Fields and observables of the system type "rigid2d", in words.
#include "engine/core/outputs.h"
#include "engine/systems/rigid2d/rigid2d_def.h"

namespace truestep::rigid2d {

const Outputs& rigid2d_outputs() {
  static const Outputs kOutputs{
      .rows = "a body, in the order of bodies and generators",
      .fields = {{"position", "m", 3, "centre of mass"},
                 {"velocity", "m/s", 3, "of the centre of mass"},
                 {"angle", "rad", 1, ""},
                 {"angular_velocity", "rad/s", 1, ""},
                 {"asleep", "1", 1, "1 while the body sleeps and is not computed"},
                 {"contact_force", "N", 3, "sum of the forces of its contacts, friction included"},
                 {"contact_load", "N", 1, "summed magnitude of their normal forces: what squeezes the body"},
                 {"joint_force", "N", 3, "sum of the forces of its joints"},
                 {"joint_torque", "N m", 1, "sum of the torques of its joints"},
                 {"orientation", "1", 4, "rotation about z as unit quaternion w x y z"},
                 {"joints.force", "N", 3, "in part joints, a row per joint: force on its second body"},
                 {"joints.torque", "N m", 1, "in part joints: torque on its second body"}},
      .observables = {{"energy.kinetic", "J", "of all dynamic bodies"},
                      {"energy.rotation", "J", "rotational part of energy.kinetic"},
                      {"energy.potential", "J", "of all conservative forces, including springs of joints"},
                      {"energy.total", "J", "their sum"},
                      {"momentum.x", "kg m/s", "of all dynamic bodies"},
                      {"momentum.y", "kg m/s", ""},
                      {"angular_momentum.z", "kg m^2/s", "about the origin"},
                      {"speed.largest", "m/s", "of all dynamic bodies"},
                      {"count", "1", "bodies"},
                      {"awake", "1", "dynamic bodies that do not sleep"},
                      {"substeps", "1", "of a step, as many as the loads on light bodies need"},
                      {"contacts", "1", "pairs of shapes that touch or nearly do"},
                      {"penetration", "m", "deepest overlap"},
                      {"sensed", "1", "pairs of a sensor and a dynamic body in it"},
                      {"joints.gap", "m", "largest distance between two points that a joint holds together"},
                      {"joints.broken", "1", "joints that have broken"},
                      {"joints.tilt", "rad", "largest rotation that violates a joint"},
                      {"joints.force", "N", "largest force in a joint"},
                      {"joints.torque", "N m", "largest torque in a joint"},
                      {"joint.<id>.force", "N", "force in the joint of that id"},
                      {"joint.<id>.torque", "N m", ""},
                      {"joint.<id>.broken", "1", "1 after it has broken"},
                      {"joint.<id>.position", "m", "prismatic and wheel joints: along the axis"},
                      {"joint.<id>.angle", "rad", "revolute and wheel joints: of b relative to a"},
                      {"joint.<id>.length", "m", "distance and spring joints: between the two points"},
                      {"power.applied", "W",
                       "if bodies have a constant force or torque: power of those without a potential"}}};
  return kOutputs;
}

}  // namespace truestep::rigid2d
