// Fields and observables of the system type "rigid3d", in words.
#include "engine/core/outputs.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep::rigid3d {

const Outputs& rigid3d_outputs() {
  static const Outputs kOutputs{
      .rows = "a body: every entry of bodies with its copies, in order, then those spawned",
      .fields = {{"position", "m", 3, "centre of mass"},
                 {"velocity", "m/s", 3, "of the centre of mass"},
                 {"orientation", "1", 4, "unit quaternion w x y z of the principal axes"},
                 {"angular_velocity", "rad/s", 3, "in the world"},
                 {"asleep", "1", 1, "1 where the body is not computed because it rests"},
                 {"shape", "1", 1, "number of its shape"},
                 {"size", "m", 3, "radius, half extents, or half length of its shape"},
                 {"contact_force", "N", 3, "sum of its contacts' forces"},
                 {"joint_force", "N", 3, "sum of its joints' forces"},
                 {"joint_torque", "N m", 3, "sum of its joints' torques"},
                 {"joints.force", "N", 3, "of part joints, a row per joint: what it puts on its second body"},
                 {"joints.torque", "N m", 3, "of the same"}},
      .observables = {{"energy.kinetic", "J", "of motion"},
                      {"energy.rotation", "J", "part of energy.kinetic that is rotation"},
                      {"energy.potential", "J", "of all forces that have one, springs of joints among them"},
                      {"energy.total", "J", "their sum"},
                      {"momentum.x", "kg m/s", "of all that moves freely"},
                      {"momentum.y", "kg m/s", ""},
                      {"momentum.z", "kg m/s", ""},
                      {"angular_momentum.x", "kg m^2/s", "about the origin"},
                      {"angular_momentum.y", "kg m^2/s", ""},
                      {"angular_momentum.z", "kg m^2/s", ""},
                      {"speed.largest", "m/s", "of all dynamic bodies"},
                      {"count", "1", "bodies"},
                      {"awake", "1", "dynamic bodies that do not sleep"},
                      {"contacts", "1", "pairs of bodies that touch or nearly do"},
                      {"penetration", "m", "deepest overlap"},
                      {"sensed", "1", "pairs of a sensor and a body in it"},
                      {"joints.gap", "m", "largest distance between points that a joint keeps together"},
                      {"joints.broken", "1", "joints that have broken"},
                      {"joints.tilt", "rad", "largest turn that a joint should not allow"},
                      {"joints.force", "N", "largest force in a joint"},
                      {"joints.torque", "N m", "largest torque in a joint"},
                      {"joint.<id>.force", "N", "force in the joint of that id"},
                      {"joint.<id>.torque", "N m", ""},
                      {"joint.<id>.broken", "1", "1 once it has broken"},
                      {"joint.<id>.position", "m", "place along its one sliding direction"},
                      {"joint.<id>.angle", "rad", "turn about its one free axis"},
                      {"joint.<id>.length", "m", "distance and spring joints: between the two points"},
                      {"joint.<id>.<axis>", "m", "x, y, z where it slides in several directions"},
                      {"joint.<id>.turn_<axis>", "rad", "about x, y, z where it turns about several axes"},
                      {"power.applied", "W",
                       "where bodies have a constant force or torque: of those without a potential"}}};
  return kOutputs;
}

}  // namespace truestep::rigid3d
