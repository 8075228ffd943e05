// A body with markers and cameras around it, for tests.
#pragma once
#include <cmath>
#include <random>

#include "engine/kernels/animation/marker_fit.h"
#include "engine/kernels/animation/triangulation.h"
#include "tests/unit/animation/animation_rig.h"

namespace truestep::animation {

inline std::vector<PinholeCamera> ring_of_cameras() {
  std::vector<PinholeCamera> out;
  for (int k = 0; k < 4; ++k) {
    const double a = 1.5707963267948966 * k + 0.3;
    out.push_back(
        camera_looking_at({4 * std::cos(a), 1.5, 4 * std::sin(a)}, {0, 1, 0}, {0, 1, 0}, 1000, 640, 480));
  }
  return out;
}

/// A body of nine joints: hips, spine, head, arms and legs, of balls and hinges.
struct Body {
  std::vector<Joint> joints;
  std::vector<MarkerPlacement> markers;
  Body() {
    const auto add = [&](int parent, const Vec3& at, JointKind kind) {
      Joint j;
      j.parent = parent, j.kind = kind, j.rest.position = at, j.axis = {1, 0, 0};
      joints.push_back(j);
      const auto n = static_cast<uint32_t>(joints.size() - 1);
      // Three on each, off its axis.
      markers.push_back({n, {0.08, -0.1, 0.03}});
      markers.push_back({n, {-0.07, -0.15, 0.05}});
      markers.push_back({n, {0.02, -0.25, -0.06}});
    };
    add(-1, {0, 0, 0}, JointKind::ball);
    add(0, {0, 0.2, 0}, JointKind::ball);
    add(1, {0, 0.4, 0}, JointKind::ball);
    add(1, {0.2, 0.35, 0}, JointKind::ball);
    add(3, {0, -0.3, 0}, JointKind::revolute);
    add(1, {-0.2, 0.35, 0}, JointKind::ball);
    add(5, {0, -0.3, 0}, JointKind::revolute);
    add(0, {0.1, -0.05, 0}, JointKind::ball);
    add(7, {0, -0.42, 0}, JointKind::revolute);
  }
  std::vector<JointMotion> pose(double t) const {
    std::vector<JointMotion> out(joints.size());
    for (size_t j = 0; j < joints.size(); ++j) {
      const double p = static_cast<double>(j);
      out[j].turn = free_rotation::turn(
          {0.5 * std::sin(2 * t + p), 0.3 * std::cos(1.7 * t + 2 * p), 0.4 * std::sin(1.3 * t - p)});
      out[j].value = 0.6 + 0.5 * std::sin(2 * t + p);
      if (joints[j].kind != JointKind::ball) out[j].turn = {};
    }
    out[0].shift = {0.5 * t, 1 + 0.05 * std::sin(6 * t), 0.1};
    return out;
  }
  std::vector<Vec3> places(const std::vector<JointMotion>& motion) const {
    std::vector<Pose> poses(joints.size());
    forward_kinematics(joints, motion, {}, poses);
    std::vector<Vec3> out;
    for (const MarkerPlacement& m : markers)
      out.push_back(poses[m.joint].position + rotate(poses[m.joint].orientation, m.point));
    return out;
  }
};
inline double angle_between(const Joint& j, const JointMotion& a, const JointMotion& b) {
  return j.kind == JointKind::ball ? norm(free_rotation::rotation_vector(conjugate(a.turn) * b.turn))
                                   : std::abs(a.value - b.value);
}

}  // namespace truestep::animation
