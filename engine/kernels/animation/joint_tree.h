// A tree of joints and their poses: forward kinematics, its derivatives, and joint limits. The frame of joint
// j in that of its parent p is
//   X_j = X_p  rest_j  (shift_j, turn_j),
// turn_j = exp(value axis) for a revolute joint, shift_j = value axis for a prismatic one, any rotation for a
// ball. A revolute and a prismatic joint have one degree of freedom; a ball has three, about the axes of its
// own frame. A point p on a later joint moves with a freedom by  a x (p - x_j)  (revolute and ball, a the
// axis in the world)  or  a (prismatic), and rotates by a or not at all.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/shape.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::animation {

enum class JointKind : uint8_t { fixed, revolute, prismatic, ball };

struct Joint {
  int32_t parent = -1;  ///< an earlier joint; -1: the root
  JointKind kind = JointKind::ball;
  Pose rest;                                              ///< in the parent's frame, at value 0
  Vec3 axis{0, 0, 1};                                     ///< unit; of a ball, the twist axis
  double min = -std::numeric_limits<double>::infinity();  ///< rad or m; of a ball, bounds of the twist
  double max = std::numeric_limits<double>::infinity();
  double cone = std::numeric_limits<double>::infinity();  ///< rad, largest swing of a ball
};

/// Coordinates of a joint. `turn` is that of a ball and ignored otherwise; `shift` is added for joints of
/// every kind.
struct JointMotion {
  double value = 0;  ///< rad or m
  Quat turn;
  Vec3 shift;  ///< m, in the joint's frame
};

/// a b: the world pose of a pose b given in a's frame.
inline Pose operator*(const Pose& a, const Pose& b) {
  return {a.position + rotate(a.orientation, b.position), a.orientation * b.orientation};
}

/// Pose of the joint's frame in its parent's.
Pose local_pose(const Joint& joint, const JointMotion& motion);
/// World poses of all joints. Parents come first.
void forward_kinematics(std::span<const Joint> joints, std::span<const JointMotion> motion, const Pose& root,
                        std::span<Pose> poses);

constexpr size_t freedoms(JointKind kind) {
  return kind == JointKind::ball ? 3 : kind == JointKind::fixed ? 0 : 1;
}
/// Whether the joint has no limits: a ball that may swing and twist by half a turn either way, others without
/// bounds.
constexpr bool unlimited(const Joint& j) {
  constexpr double kHalfTurn = 3.141592653589793;
  if (j.kind == JointKind::ball) return j.cone >= kHalfTurn && j.min <= -kHalfTurn && j.max >= kHalfTurn;
  return j.kind == JointKind::fixed || (j.min == -std::numeric_limits<double>::infinity() &&
                                        j.max == std::numeric_limits<double>::infinity());
}
/// World axis of the joint's freedom k.
Vec3 freedom_axis(const Joint& joint, const Pose& pose, size_t k);

/// Changes a freedom by `by` (rad or m).
void move_freedom(const Joint& joint, size_t k, double by, JointMotion& motion);

/// Clamps the motion to the limits; true if it was beyond them.
bool apply_limits(const Joint& joint, JointMotion& motion);
/// Whether freedom k is at a limit that a change with the sign of `by` would violate.
bool blocked(const Joint& joint, const JointMotion& motion, size_t k, double by);

}  // namespace truestep::animation
