// Joints between bodies, as they were built: anchors and axes in the bodies' frames, and which of the six
// ways of moving are locked. Rows of the state say which bodies they hold now, what they carry and whether
// they broke.
#pragma once
#include <array>
#include <limits>
#include <vector>

#include "engine/systems/rigid3d/bodies.h"

namespace truestep {

struct Joint {
  std::array<uint32_t, 2> bodies;  ///< rows at t = 0, kNoBody: the world
  Vec3 anchor_a, anchor_b;         ///< m, in the bodies' frames
  Vec3 axes[3];                    ///< unit, in a's frame; the first is the joint's own
  Vec3 axis_b;                     ///< the first as b has it
  Quat turn;                       ///< b's orientation seen from a at t = 0
  std::array<uint8_t, 6> locked;   ///< linear, angular along the axes
  enum class Turns : uint8_t { none, about_axis, any } turns = Turns::any;
  double break_force = std::numeric_limits<double>::infinity();  ///< N
  JointDef::Touch touch = JointDef::Touch::no;
};

/// All joints of the scene. Error "scene_invalid" with pointers when one names a body that is not there.
std::vector<Joint> build_joints(const Rigid3dDef& def, const BodyList& bodies);

/// Where a joint is: x_b + r_b - x_a - r_a (m), and the turn of b against a that it does not allow (rad).
struct JointPlace {
  Vec3 arm_a, arm_b, gap, axes[3], turn;
};
JointPlace joint_place(const Joint& joint, const Pose& a, const Pose& b);

}  // namespace truestep
