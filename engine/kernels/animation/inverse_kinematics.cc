#include "engine/kernels/animation/inverse_kinematics.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/animation/aim.h"

namespace truestep::animation {

using free_rotation::rotation_vector;

TwoLinkAngles two_link_angles(double l1, double l2, double x, double y) {
  const double d2 = x * x + y * y, d = std::sqrt(d2);
  TwoLinkAngles out;
  out.miss = std::max({d - (l1 + l2), std::abs(l1 - l2) - d, 0.0});
  const double cosine = std::clamp((d2 - l1 * l1 - l2 * l2) / (2 * l1 * l2), -1.0, 1.0);
  // From the sine, which stays accurate near a stretched arm.
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  using enum TwoLinkAngles::Reach;
  constexpr double kStraight = 1e-6;
  if (sine < kStraight) out.reach = one;
  // Rounding errors at exact reach are not a miss.
  if (out.miss > 1e-12 * (l1 + l2)) out.reach = d > l1 + l2 ? too_far : too_near;
  for (int k = 0; k < 2; ++k) {
    const double s = k == 0 ? sine : -sine;
    out.second[k] = trig::atan2(s, cosine);
    out.first[k] = trig::atan2(y, x) - trig::atan2(l2 * s, l1 + l2 * cosine);
  }
  return out;
}

void ik_columns(std::span<const Joint> joints, std::span<const IkGoal> goals, IkWork& w) {
  w.moves.assign(joints.size(), 0);
  for (const IkGoal& g : goals) {
    for (auto j = static_cast<int32_t>(g.joint); j >= static_cast<int32_t>(g.base);
         j = joints[static_cast<size_t>(j)].parent) {
      w.moves[static_cast<size_t>(j)] = 1;
      if (j == static_cast<int32_t>(g.base)) break;
    }
  }
  // In reverse, so that the children of a joint are listed in ascending order.
  w.first_child.assign(joints.size(), IkWork::kNone), w.next_child.assign(joints.size(), IkWork::kNone);
  for (size_t j = joints.size(); j-- > 0;) {
    if (!w.moves[j] || joints[j].parent < 0) continue;
    uint32_t& first = w.first_child[static_cast<size_t>(joints[j].parent)];
    w.next_child[j] = first, first = static_cast<uint32_t>(j);
  }
  w.joint_of.clear(), w.freedom_of.clear();
  for (uint32_t j = 0; j < joints.size(); ++j) {
    for (uint32_t k = 0; w.moves[j] && k < freedoms(joints[j].kind); ++k) {
      w.joint_of.push_back(j), w.freedom_of.push_back(k);
    }
  }
}

void ik_jacobian(std::span<const Joint> joints, std::span<const IkGoal> goals, IkWork& w) {
  const size_t n = w.joint_of.size();
  size_t rows = 0;
  for (const IkGoal& g : goals) rows += ik_rows(g);
  w.jacobian.assign(rows * n, 0);
  size_t row = 0;
  for (const IkGoal& g : goals) {
    const Pose& end = w.poses[g.joint];
    const Vec3 place = end.position + rotate(end.orientation, g.point);
    // Only joints on the goal's own chain contribute; columns ascend by joint.
    size_t c = n;
    for (auto j = static_cast<int32_t>(g.joint); j >= 0; j = joints[static_cast<size_t>(j)].parent) {
      const auto at = static_cast<uint32_t>(j);
      while (c > 0 && w.joint_of[c - 1] > at) --c;
      while (c > 0 && w.joint_of[c - 1] == at) {
        --c;
        const Joint& joint = joints[at];
        const Vec3 axis = freedom_axis(joint, w.poses[at], w.freedom_of[c]);
        const bool slides = joint.kind == JointKind::prismatic;
        const Vec3 move = (slides ? axis : cross(axis, place - w.poses[at].position)) * g.weight;
        for (size_t k = 0; k < 3; ++k) w.jacobian[(row + k) * n + c] = (&move.x)[k];
        if (!g.orientation || slides) continue;
        for (size_t k = 0; k < 3; ++k) {
          w.jacobian[(row + 3 + k) * n + c] = (&axis.x)[k] * g.weight * g.orientation_weight;
        }
      }
      if (at == g.base) break;
    }
    row += ik_rows(g);
  }
}

namespace {

/// Rotates a ball joint by a rotation in the world; returns what its limits leave of it.
Quat turn_ball(const Joint& joint, const Pose& pose, const Quat& by, JointMotion& motion) {
  const Quat before = motion.turn, back = conjugate(pose.orientation);
  motion.turn = normalized(before * (back * by * pose.orientation));
  if (!apply_limits(joint, motion)) return by;
  return normalized(pose.orientation * (conjugate(before) * motion.turn) * back);
}

}  // namespace

Quat ik::turn_joint(const Joint& joint, const Pose& pose, const Vec3& by, JointMotion& motion) {
  if (joint.kind == JointKind::revolute) {
    const double before = motion.value;
    motion.value += dot(by, rotate(pose.orientation, joint.axis));
    apply_limits(joint, motion);
    return turn_about(rotate(pose.orientation, joint.axis), motion.value - before);
  }
  return joint.kind == JointKind::ball ? turn_ball(joint, pose, free_rotation::turn(by), motion) : Quat{};
}

Quat ik::aim(const Joint& joint, const Pose& pose, const Vec3& from, const Vec3& to, JointMotion& motion) {
  if (joint.kind == JointKind::revolute) {
    const Vec3 axis = rotate(pose.orientation, joint.axis);
    const Vec3 a = from - axis * dot(axis, from), b = to - axis * dot(axis, to);
    if (norm2(a) == 0 || norm2(b) == 0) return {};
    return turn_joint(joint, pose, axis * trig::atan2(dot(axis, cross(a, b)), dot(a, b)), motion);
  }
  if (joint.kind != JointKind::ball || norm2(from) == 0 || norm2(to) == 0) return {};
  return turn_ball(joint, pose, rotation_between(normalized(from), normalized(to)), motion);
}

double ik::error_of(std::span<const IkGoal> goals, std::span<const Pose> poses) {
  double error = 0;
  for (const IkGoal& g : goals) {
    const Pose& end = poses[g.joint];
    error = std::max(error, norm(g.target - end.position - rotate(end.orientation, g.point)));
    if (!g.orientation) continue;
    const Vec3 off = rotation_vector(*g.orientation * conjugate(end.orientation));
    error = std::max(error, g.orientation_weight * norm(off));
  }
  return error;
}

void ik::turn_to_places(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                        std::span<JointMotion> motion, IkWork& w) {
  const size_t n = joints.size();
  for (size_t j = 0; j < n; ++j) {
    const int32_t parent = joints[j].parent;
    const Pose& before = parent < 0 ? root : w.poses[static_cast<size_t>(parent)];
    w.poses[j] = before * local_pose(joints[j], motion[j]);
    if (!w.moves[j] || joints[j].kind == JointKind::fixed) continue;
    // A single child or goal is aimed at its position; of several, the mean rotation is taken.
    const Pose& pose = w.poses[j];
    const auto each = [&](auto&& use) {
      for (uint32_t c = w.first_child[j]; c != IkWork::kNone; c = w.next_child[c]) {
        const Vec3 local = local_pose(joints[c], motion[c]).position;
        if (norm2(local) > 0) use(rotate(pose.orientation, local), w.places[c] - pose.position);
      }
      for (size_t g = 0; g < goals.size(); ++g) {
        if (goals[g].joint != j || norm2(goals[g].point) == 0) continue;
        use(rotate(pose.orientation, goals[g].point), w.places[n + g] - pose.position);
      }
    };
    int count = 0;
    Vec3 from, to, sum;
    each([&](const Vec3& a, const Vec3& b) { ++count, from = a, to = b; });
    if (count == 0) continue;
    if (count == 1) {
      aim(joints[j], pose, from, to, motion[j]);
    } else {
      Joint free_joint;
      free_joint.kind = joints[j].kind, free_joint.axis = joints[j].axis;
      each([&](const Vec3& a, const Vec3& b) {
        JointMotion tried = motion[j];
        sum += rotation_vector(aim(free_joint, pose, a, b, tried));
      });
      turn_joint(joints[j], pose, sum / count, motion[j]);
    }
    w.poses[j] = before * local_pose(joints[j], motion[j]);
  }
}

void ik::turn_to_pole(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                      std::span<JointMotion> motion, IkWork& w) {
  for (const IkGoal& g : goals) {
    if (!g.pole || joints[g.base].kind != JointKind::ball) continue;
    const Pose& base = w.poses[g.base];
    const Pose& end = w.poses[g.joint];
    const Vec3 line = end.position + rotate(end.orientation, g.point) - base.position;
    if (!(norm2(line) > 0)) continue;
    const Vec3 u = normalized(line);
    // The joint farthest from the line gives the direction in which the chain bends.
    Vec3 bend;
    for (auto j = static_cast<int32_t>(g.joint); j > static_cast<int32_t>(g.base);
         j = joints[static_cast<size_t>(j)].parent) {
      const Vec3 off = w.poses[static_cast<size_t>(j)].position - base.position;
      const Vec3 across = off - u * dot(u, off);
      if (norm2(across) > norm2(bend)) bend = across;
    }
    const Vec3 to = *g.pole - base.position, side = to - u * dot(u, to);
    if (norm2(bend) < 1e-18 || norm2(side) < 1e-18) continue;
    const double angle = trig::atan2(dot(u, cross(bend, side)), dot(bend, side));
    turn_joint(joints[g.base], base, u * angle, motion[g.base]);
    forward_kinematics(joints, motion, root, w.poses);
  }
}

IkResult solve_ik(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  w.poses.resize(joints.size()), w.tried_poses.resize(joints.size()), w.tried.resize(joints.size());
  forward_kinematics(joints, motion, root, w.poses);
  if (goals.empty()) return {};
  w.sorted.assign(goals.begin(), goals.end());
  // Stable insertion sort by priority: goals are few, and the standard library's stable sort allocates.
  for (size_t i = 1; i < w.sorted.size(); ++i) {
    for (size_t k = i; k > 0 && w.sorted[k].priority < w.sorted[k - 1].priority; --k) {
      std::swap(w.sorted[k], w.sorted[k - 1]);
    }
  }
  ik_columns(joints, w.sorted, w);
  IkResult out;
  switch (options.method) {
    case IkMethod::gradient:
    case IkMethod::gauss_newton:
    case IkMethod::damped_least_squares:
      out = ik::least_squares(joints, root, w.sorted, options, motion, w);
      break;
    case IkMethod::ccd:
      out = ik::ccd(joints, root, w.sorted, options, motion, w);
      break;
    case IkMethod::fabrik:
      out = ik::fabrik(joints, root, w.sorted, options, motion, w);
      break;
    case IkMethod::two_link:
      out = ik::two_link(joints, root, w.sorted, options, motion, w);
      break;
  }
  if (options.method != IkMethod::two_link) ik::turn_to_pole(joints, root, w.sorted, motion, w);
  out.error = ik::error_of(w.sorted, w.poses);
  return out;
}

}  // namespace truestep::animation
