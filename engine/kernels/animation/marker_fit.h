// A skeleton in markers: coordinates of all joints, and the place of the root, that bring the markers'
// places on their joints nearest to where they were seen,
//   sum w |m_i - (x_j + R_j p_i)|^2 + e sum |dq|^2 -> min   over what was seen,
// by Levenberg and Marquardt on the normal equations; dq is the change from the pose that the fit starts at,
// e so small that it only says where nothing else does (markers out of sight). Joints that no marker on them
// or after them tells anything about keep their coordinates, and are named. No test for outliers.
#pragma once
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation {

struct MarkerPlacement {
  uint32_t joint = 0;
  Vec3 point;  ///< m, in the joint's frame
};
struct MarkerFit {
  double error = 0;  ///< m, root of the mean square distance of the markers seen
  int iterations = 0;
};
struct MarkerWork {
  std::vector<Pose> poses, tried_poses;
  std::vector<JointMotion> tried;
  std::vector<uint32_t> joint_of, freedom_of;
  std::vector<double> normal, factor, gradient, step, column, pulled;
};
/// `seen`: per marker, whether it was. The first joint's shift becomes the root's place. `known`: per joint,
/// whether what was seen told anything about it.
MarkerFit fit_markers(std::span<const Joint> joints, std::span<const MarkerPlacement> markers,
                      std::span<const Vec3> places, std::span<const uint8_t> seen,
                      std::span<JointMotion> motion, std::span<uint8_t> known, MarkerWork& work);

}  // namespace truestep::animation
