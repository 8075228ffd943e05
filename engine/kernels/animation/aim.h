// Rotations of single joints, the building blocks of inverse kinematics solvers.
#pragma once
#include "engine/kernels/animation/joint_tree.h"

namespace truestep::animation::ik {

/// Rotates a joint by a rotation vector (rad, in the world) as far as its kind and its limits allow; returns
/// the actual rotation in the world. `pose` is the joint's pose before.
Quat turn_joint(const Joint& joint, const Pose& pose, const Vec3& by, JointMotion& motion);
/// Rotates it by the smallest rotation that takes the direction `from` to `to` (world, any lengths); for a
/// revolute joint, within the plane perpendicular to its axis.
Quat aim(const Joint& joint, const Pose& pose, const Vec3& from, const Vec3& to, JointMotion& motion);

}  // namespace truestep::animation::ik
