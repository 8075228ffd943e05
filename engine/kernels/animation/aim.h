// Turns of single joints, which solvers of inverse kinematics are made of.
#pragma once
#include "engine/kernels/animation/joint_tree.h"

namespace truestep::animation::ik {

/// Turns a joint by the world's rotation vector (rad) as far as its kind and its limits let it; the world's
/// rotation that it made. `pose` is the joint's, before.
Quat turn_joint(const Joint& joint, const Pose& pose, const Vec3& by, JointMotion& motion);
/// Turns it by the smallest rotation that takes the direction `from` to `to` (world, any lengths): of a
/// revolute joint in the plane across its axis.
Quat aim(const Joint& joint, const Pose& pose, const Vec3& from, const Vec3& to, JointMotion& motion);

}  // namespace truestep::animation::ik
