// Fit of a skeleton to markers: the joint coordinates and the root position that bring the markers' points on
// their joints closest to where they were seen,
//   sum w |m_i - (x_j + R_j p_i)|^2 + e sum |dq|^2 -> min   over the markers seen,
// by Levenberg-Marquardt on the normal equations; dq is the change from the starting pose, and e is so small
// that it only decides what nothing else does (markers out of sight). Joints about which no marker on them or
// beyond them gives information keep their coordinates and are reported.
//
// Impossible markers (mislabelled ones, reflections) are recognized by their distances: if one is farther off
// than six spreads s (of a coordinate, from the median), the fit is repeated with Tukey's weights
//   w = (1 - (r/c)^2)^2,  r < c,   else 0          (Beaton, Tukey 1974)
// with c decreasing from the largest distance to 4.7 s, both from the given pose and from the fit to all
// markers, and ends as a fit to the markers within that distance (Rousseeuw, Leroy 1987, section 1.2).
// Without such a marker none of this happens. More than half of the markers that determine a joint must be
// right.
#pragma once
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation {

struct MarkerPlacement {
  uint32_t joint = 0;
  Vec3 point;  ///< m, in the joint's frame
};
struct MarkerFit {
  double error = 0;  ///< m, root mean square distance of the markers that count
  int iterations = 0;
  double spread = 0;    ///< m, of a coordinate, from the median distance of all markers seen
  size_t outliers = 0;  ///< markers seen but rejected
};
struct MarkerWork {
  std::vector<Pose> poses, tried_poses;
  std::vector<JointMotion> tried, start;
  std::vector<uint32_t> joint_of, freedom_of;
  std::vector<double> weights, distances, sorted;  ///< per marker
  std::vector<double> normal, factor, gradient, step, column, pulled;
};
/// `seen`: per marker, whether it was seen; `work.weights` becomes 1 for markers that count in the end, else
/// 0. The first joint's shift becomes the root's position. `known`: per joint, whether the markers seen gave
/// any information about it.
MarkerFit fit_markers(std::span<const Joint> joints, std::span<const MarkerPlacement> markers,
                      std::span<const Vec3> places, std::span<const uint8_t> seen,
                      std::span<JointMotion> motion, std::span<uint8_t> known, MarkerWork& work);

}  // namespace truestep::animation
