#include "engine/kernels/animation/joint_tree.h"

#include <algorithm>
#include <cmath>

namespace truestep::animation {

using free_rotation::rotation_vector;
using free_rotation::turn;

namespace {
// rad or m; a freedom this close to a limit counts as at the limit.
constexpr double kAtLimit = 1e-9;
}  // namespace

Pose local_pose(const Joint& joint, const JointMotion& motion) {
  Pose local{motion.shift, {}};
  switch (joint.kind) {
    case JointKind::fixed:
      break;
    case JointKind::revolute:
      local.orientation = turn_about(joint.axis, motion.value);
      break;
    case JointKind::prismatic:
      local.position += joint.axis * motion.value;
      break;
    case JointKind::ball:
      local.orientation = motion.turn;
      break;
  }
  return joint.rest * local;
}

void forward_kinematics(std::span<const Joint> joints, std::span<const JointMotion> motion, const Pose& root,
                        std::span<Pose> poses) {
  for (size_t j = 0; j < joints.size(); ++j) {
    const int32_t parent = joints[j].parent;
    poses[j] = (parent < 0 ? root : poses[static_cast<size_t>(parent)]) * local_pose(joints[j], motion[j]);
  }
}

Vec3 freedom_axis(const Joint& joint, const Pose& pose, size_t k) {
  if (joint.kind != JointKind::ball) return rotate(pose.orientation, joint.axis);
  return rotate(pose.orientation, {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0});
}

void move_freedom(const Joint& joint, size_t k, double by, JointMotion& motion) {
  if (joint.kind != JointKind::ball) {
    motion.value += by;
    return;
  }
  motion.turn = normalized(motion.turn * turn({k == 0 ? by : 0.0, k == 1 ? by : 0.0, k == 2 ? by : 0.0}));
}

bool apply_limits(const Joint& joint, JointMotion& motion) {
  if (unlimited(joint)) return false;
  if (joint.kind != JointKind::ball) {
    const double value = std::clamp(motion.value, joint.min, joint.max);
    const bool beyond = value != motion.value;
    motion.value = value;
    return beyond;
  }
  auto [swing, twist] = swing_twist(motion.turn, joint.axis);
  const Vec3 swung = rotation_vector(swing);
  const double angle = norm(swung), held = std::clamp(twist, joint.min, joint.max);
  if (angle <= joint.cone && held == twist) return false;
  if (angle > joint.cone) swing = turn(swung * (joint.cone / angle));
  motion.turn = normalized(swing * turn_about(joint.axis, held));
  return true;
}

bool blocked(const Joint& joint, const JointMotion& motion, size_t k, double by) {
  if (joint.kind == JointKind::fixed) return true;
  if (unlimited(joint)) return false;
  if (joint.kind != JointKind::ball) {
    return (by > 0 && motion.value >= joint.max - kAtLimit) ||
           (by < 0 && motion.value <= joint.min + kAtLimit);
  }
  // The limits of a ball are curved: a move counts as blocked if the limits would undo all of it.
  JointMotion tried = motion;
  const double step = std::copysign(1e-6, by);
  move_freedom(joint, k, step, tried);
  if (!apply_limits(joint, tried)) return false;
  return norm(rotation_vector(conjugate(motion.turn) * tried.turn)) < 0.5e-6;
}

}  // namespace truestep::animation
