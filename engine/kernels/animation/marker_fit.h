// A skeleton in markers: coordinates of all joints, and the place of the root, that bring the markers'
// places on their joints nearest to where they were seen,
//   sum w |m_i - (x_j + R_j p_i)|^2 + e sum |dq|^2 -> min   over what was seen,
// by Levenberg and Marquardt on the normal equations; dq is the change from the pose that the fit starts at,
// e so small that it only says where nothing else does (markers out of sight). Joints that no marker on them
// or after them tells anything about keep their coordinates, and are named.
//
// Markers that are where none can be (taken for another, a reflection) are found by their distances: where
// one is beyond six spreads s (of a coordinate, by the median), the fit is repeated with Tukey's weights
//   w = (1 - (r/c)^2)^2,  r < c,   else 0          (Beaton, Tukey 1974)
// c from the largest distance down to 4.7 s, from the pose given and from that of all markers, and ends as a
// fit to those within that (Rousseeuw, Leroy 1987, section 1.2). Where none is, nothing of that is done. More
// than half of what tells about a joint must be right.
#pragma once
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation {

struct MarkerPlacement {
  uint32_t joint = 0;
  Vec3 point;  ///< m, in the joint's frame
};
struct MarkerFit {
  double error = 0;  ///< m, root of the mean square distance of the markers that count
  int iterations = 0;
  double spread = 0;    ///< m, of a coordinate, by the median distance of all markers seen
  size_t outliers = 0;  ///< seen, and set aside
};
struct MarkerWork {
  std::vector<Pose> poses, tried_poses;
  std::vector<JointMotion> tried, start;
  std::vector<uint32_t> joint_of, freedom_of;
  std::vector<double> weights, distances, sorted;  ///< per marker
  std::vector<double> normal, factor, gradient, step, column, pulled;
};
/// `seen`: per marker, whether it was; in `work.weights` 1 for those that count in the end, else 0. The first
/// joint's shift becomes the root's place. `known`: per joint, whether what was seen told anything about it.
MarkerFit fit_markers(std::span<const Joint> joints, std::span<const MarkerPlacement> markers,
                      std::span<const Vec3> places, std::span<const uint8_t> seen,
                      std::span<JointMotion> motion, std::span<uint8_t> known, MarkerWork& work);

}  // namespace truestep::animation
