// Soft limits of a ball, as those of a skeleton's (kernels/animation/joint_tree.h): its unit quaternion
// (w, u) is a swing across the axis a after a twist about it,
//   twist = 2 atan2(p, w),   swing = 2 acos(c),   p = u . a,   c^2 = w^2 + p^2,   s^2 = 1 - c^2,
// which change with the angular velocity in the link's frame by
//   g = (w^2 a + w a x u + p u) / c^2   and   h = (w u - p w a - p a x u) / (c s)
// (from q' = q (0, omega) / 2). Beyond a limit a spring and a damper push back along these, never pulling.
#pragma once
#include "engine/systems/articulation/model.h"
#include "engine/systems/articulation/tree_newton.h"

namespace truestep::articulation {

struct BallLimit {
  Vec3 torque;        ///< N m, in the link's frame
  double energy = 0;  ///< J
};
/// `q`: four numbers of any length but 0; `omega` in the link's frame.
BallLimit ball_limit(const Drive& drive, const Vec3& axis, const double* q, const Vec3& omega);
/// Adds the slopes of what pushes, k g g^T: without the curvature of the limits, and without dampers, which
/// slow Newton's iterations down and change nothing of what they find.
void add_ball_limit_slope(const Drive& drive, const Vec3& axis, const double* q, DriveSlope& out);

}  // namespace truestep::articulation
