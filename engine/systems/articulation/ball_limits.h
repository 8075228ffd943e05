// Soft limits of a ball joint, as for a skeleton's (kernels/animation/joint_tree.h): its unit quaternion (w,
// u) is a swing across the axis a after a twist about it,
//   twist = 2 atan2(p, w),   swing = 2 acos(c),   p = u . a,   c^2 = w^2 + p^2,   s^2 = 1 - c^2,
// whose gradients by the angular velocity in the link's frame are
//   g = (w^2 a + w a x u + p u) / c^2   and   h = (w u - p w a - p a x u) / (c s)
// (from q' = q (0, omega) / 2). Beyond a limit a spring and a damper push back along these and never pull.
#pragma once
#include "engine/systems/articulation/model.h"
#include "engine/systems/articulation/tree_newton.h"

namespace truestep::articulation {

struct BallLimit {
  Vec3 torque;        ///< N m, in the link's frame
  double energy = 0;  ///< J
};
/// `q`: a quaternion of any length but 0; `omega` in the link's frame.
BallLimit ball_limit(const Drive& drive, const Vec3& axis, const double* q, const Vec3& omega);
/// Adds the stiffness k g g^T of active limits, without their curvature and without dampers, which slow
/// Newton's iterations without changing their result.
void add_ball_limit_slope(const Drive& drive, const Vec3& axis, const double* q, DriveSlope& out);

}  // namespace truestep::articulation
