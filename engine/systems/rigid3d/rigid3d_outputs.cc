// Fields and observables of the system type "rigid3d", in words.
#include "engine/core/outputs.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep::rigid3d {

const Outputs& rigid3d_outputs() {
  static const Outputs kOutputs{
      .rows = "a body: every entry of bodies with its copies, in order, then spawned bodies",
      .fields = {{"position", "m", 3, "centre of mass"},
                 {"velocity", "m/s", 3, "of the centre of mass"},
                 {"orientation", "1", 4, "unit quaternion w x y z of the principal axes"},
                 {"angular_velocity", "rad/s", 3, "in the world"},
                 {"asleep", "1", 1, "1 while the body sleeps and is not computed"},
                 {"shape", "1", 1, "index of its shape"},
                 {"size", "m", 3, "radius, half extents or half length of its shape"},
                 {"contact_force", "N", 3, "sum of the forces of its contacts, friction included"},
                 {"contact_load", "N", 1, "summed magnitude of their normal forces: what squeezes the body"},
                 {"joint_force", "N", 3, "sum of the forces of its joints"},
                 {"joint_torque", "N m", 3, "sum of the torques of its joints"},
                 {"joints.force", "N", 3, "in part joints, a row per joint: force on its second body"},
                 {"joints.torque", "N m", 3, "in part joints: torque on its second body"}},
      .observables = {{"energy.kinetic", "J", "of all dynamic bodies"},
                      {"energy.rotation", "J", "rotational part of energy.kinetic"},
                      {"energy.potential", "J", "of all conservative forces, including springs of joints"},
                      {"energy.total", "J", "their sum"},
                      {"momentum.x", "kg m/s", "of all dynamic bodies"},
                      {"momentum.y", "kg m/s", ""},
                      {"momentum.z", "kg m/s", ""},
                      {"angular_momentum.x", "kg m^2/s", "about the origin"},
                      {"angular_momentum.y", "kg m^2/s", ""},
                      {"angular_momentum.z", "kg m^2/s", ""},
                      {"speed.largest", "m/s", "of all dynamic bodies"},
                      {"count", "1", "bodies"},
                      {"awake", "1", "dynamic bodies that do not sleep"},
                      {"substeps", "1", "of a step, as many as the loads on light bodies need"},
                      {"contacts", "1", "pairs of bodies that touch or nearly do"},
                      {"penetration", "m", "deepest overlap"},
                      {"sensed", "1", "pairs of a sensor and a body in it"},
                      {"joints.gap", "m", "largest distance between two points that a joint holds together"},
                      {"joints.broken", "1", "joints that have broken"},
                      {"joints.tilt", "rad", "largest rotation that violates a joint"},
                      {"joints.force", "N", "largest force in a joint"},
                      {"joints.torque", "N m", "largest torque in a joint"},
                      {"joint.<id>.force", "N", "force in the joint of that id"},
                      {"joint.<id>.torque", "N m", ""},
                      {"joint.<id>.broken", "1", "1 after it has broken"},
                      {"joint.<id>.position", "m", "position along its single translation"},
                      {"joint.<id>.angle", "rad", "angle about its single free axis"},
                      {"joint.<id>.length", "m", "distance and spring joints: between the two points"},
                      {"joint.<id>.<axis>", "m", "position along x, y, z if it has several translations"},
                      {"joint.<id>.turn_<axis>", "rad", "angle about x, y, z if it has several rotations"},
                      {"power.applied", "W",
                       "if bodies have a constant force or torque: power of those without a potential"}}};
  return kOutputs;
}

}  // namespace truestep::rigid3d
