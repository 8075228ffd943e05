// Solvers that work along chains: cyclic coordinate descent, FABRIK, and the closed form of two links.
#include <algorithm>
#include <cmath>

#include "engine/kernels/animation/aim.h"
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation::ik {

namespace {

Vec3 end_of(const IkGoal& g, std::span<const Pose> poses) {
  return poses[g.joint].position + rotate(poses[g.joint].orientation, g.point);
}

/// Chains that lie on the line to their targets never leave it by themselves: they are bent by a hair.
void unstraighten(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  std::span<JointMotion> motion, IkWork& w) {
  constexpr double kStraight = 1e-7, kHair = 1e-3;  // of the way to the target; rad
  for (const IkGoal& g : goals) {
    const Vec3 start = w.poses[g.base].position, line = g.target - start;
    const double reach = norm(line) + norm(end_of(g, w.poses) - start);
    const Vec3 u = normalized(line);
    const auto across = [&](const Vec3& x) { return norm((x - start) - u * dot(u, x - start)); };
    double off = across(end_of(g, w.poses));
    for (auto j = static_cast<int32_t>(g.joint); j > static_cast<int32_t>(g.base);
         j = joints[static_cast<size_t>(j)].parent) {
      off = std::max(off, across(w.poses[static_cast<size_t>(j)].position));
    }
    if (off > kStraight * reach) continue;
    double by = kHair;
    const Vec3 axis = normalized(std::abs(u.z) < 0.9 ? cross(u, Vec3{0, 0, 1}) : cross(u, Vec3{1, 0, 0}));
    for (auto j = static_cast<int32_t>(g.joint); j >= static_cast<int32_t>(g.base);
         j = joints[static_cast<size_t>(j)].parent) {
      const auto k = static_cast<size_t>(j);
      const bool hinge = joints[k].kind == JointKind::revolute;
      turn_joint(joints[k], w.poses[k],
                 (hinge ? freedom_axis(joints[k], w.poses[k], 0) : cross(u, axis)) * by, motion[k]);
      by = -1.5 * by;
      if (j == static_cast<int32_t>(g.base) || std::abs(by) > 0.5) break;
    }
  }
  forward_kinematics(joints, motion, root, w.poses);
}

}  // namespace

IkResult ccd(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
             const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  using enum IkResult::End;
  constexpr double kProgress = 1e-7;  // of the error in an iteration; less is none
  double error = error_of(goals, w.poses);
  if (error > options.tolerance) unstraighten(joints, root, goals, motion, w);
  int rests = 0;
  for (int n = 0; n < options.most; ++n) {
    if (error <= options.tolerance) return {error, n, reached};
    for (const IkGoal& g : goals) {
      Vec3 end = end_of(g, w.poses);
      for (auto j = static_cast<int32_t>(g.joint);; j = joints[static_cast<size_t>(j)].parent) {
        const auto k = static_cast<size_t>(j);
        const Pose& pose = w.poses[k];
        if (joints[k].kind == JointKind::prismatic) {
          const Vec3 axis = freedom_axis(joints[k], pose, 0);
          const double before = motion[k].value;
          motion[k].value += dot(axis, g.target - end);
          apply_limits(joints[k], motion[k]);
          end += axis * (motion[k].value - before);
        } else {
          const Vec3 arm = end - pose.position;
          end = pose.position + rotate(aim(joints[k], pose, arm, g.target - pose.position, motion[k]), arm);
        }
        if (k == g.base) break;
      }
      forward_kinematics(joints, motion, root, w.poses);
    }
    const double before = error;
    error = error_of(goals, w.poses);
    rests = before - error < kProgress * before ? rests + 1 : 0;
    if (rests >= 5 && error > options.tolerance) return {error, n + 1, stalled};
  }
  return {error, options.most, error <= options.tolerance ? reached : exhausted};
}

namespace {

class Fabrik {
 public:
  Fabrik(std::span<const Joint> joints, std::span<const IkGoal> goals, std::span<const JointMotion> motion,
         IkWork& w)
      : joints_(joints), goals_(goals), w_(w), n_(joints.size()) {
    w_.lengths.assign(n_ + goals.size(), 0);
    w_.path.clear();
    for (uint32_t j = 0; j < n_; ++j) {
      if (!w_.moves[j]) continue;
      w_.path.push_back(j);
      w_.lengths[j] = norm(local_pose(joints[j], motion[j]).position);
    }
    for (size_t g = 0; g < goals.size(); ++g) w_.lengths[n_ + g] = norm(goals[g].point);
    w_.places.resize(n_ + goals.size()), w_.proposals.resize(n_ + goals.size());
    w_.counts.resize(n_ + goals.size());
    free_ = all_free();
  }
  bool free() const { return free_; }
  bool is_base(size_t j) const {
    return joints_[j].parent < 0 || !w_.moves[static_cast<size_t>(joints_[j].parent)];
  }

  void read_places() {
    for (const uint32_t j : w_.path) w_.places[j] = w_.poses[j].position;
    for (size_t g = 0; g < goals_.size(); ++g) w_.places[n_ + g] = end_of(goals_[g], w_.poses);
  }
  double error() const {
    double e = 0;
    for (size_t g = 0; g < goals_.size(); ++g) e = std::max(e, norm(w_.places[end(g)] - goals_[g].target));
    return e;
  }
  /// From the targets to the bases: each place as near to the one after it as the bone is long.
  void backward() {
    for (const uint32_t j : w_.path) w_.counts[j] = 0, w_.proposals[j] = {};
    for (size_t g = 0; g < goals_.size(); ++g) {
      const uint32_t j = goals_[g].joint;
      w_.places[n_ + g] = goals_[g].target;
      propose(j, w_.lengths[n_ + g] > 0 ? at_length(goals_[g].target, w_.places[j], w_.lengths[n_ + g])
                                        : goals_[g].target);
    }
    for (size_t k = w_.path.size(); k-- > 0;) {
      const uint32_t j = w_.path[k];
      if (w_.counts[j] > 0) w_.places[j] = w_.proposals[j] / static_cast<double>(w_.counts[j]);
      if (is_base(j)) continue;
      const auto p = static_cast<size_t>(joints_[j].parent);
      propose(p, at_length(w_.places[j], w_.places[p], w_.lengths[j]));
    }
  }
  /// From the bases, which stay where they are, to the ends.
  void forward() {
    for (const uint32_t j : w_.path) {
      if (is_base(j)) {
        w_.places[j] = w_.poses[j].position;
        continue;
      }
      const Vec3& parent = w_.places[static_cast<size_t>(joints_[j].parent)];
      w_.places[j] = at_length(parent, w_.places[j], w_.lengths[j]);
    }
    for (size_t g = 0; g < goals_.size(); ++g) {
      const Vec3& joint = w_.places[goals_[g].joint];
      w_.places[n_ + g] = at_length(joint, w_.places[n_ + g], w_.lengths[n_ + g]);
    }
  }
  /// A chain that cannot reach its target points at it; false where it can.
  bool stretch() {
    if (!free_ || goals_.size() != 1) return false;
    double reach = w_.lengths[n_];
    for (const uint32_t j : w_.path) reach += is_base(j) ? 0 : w_.lengths[j];
    const Vec3 base = w_.poses[goals_[0].base].position, to = goals_[0].target - base;
    if (norm(to) <= reach) return false;
    const Vec3 u = normalized(to);
    double along = 0;
    for (const uint32_t j : w_.path) {
      along += is_base(j) ? 0 : w_.lengths[j];
      w_.places[j] = base + u * along;
    }
    w_.places[n_] = base + u * reach;
    return true;
  }

 private:
  size_t end(size_t g) const { return w_.lengths[n_ + g] > 0 ? n_ + g : goals_[g].joint; }
  static Vec3 at_length(const Vec3& from, const Vec3& towards, double length) {
    const Vec3 d = towards - from;
    const double n = norm(d);
    return n > 0 ? from + d * (length / n) : from + Vec3{0, length, 0};
  }
  void propose(size_t j, const Vec3& place) { w_.proposals[j] += place, ++w_.counts[j]; }
  /// Whether any places at the bones' lengths can be turned to: balls without limits, one bone on each.
  bool all_free() const {
    for (const uint32_t j : w_.path) {
      size_t bones = 0;
      for (uint32_t c = w_.first_child[j]; c != IkWork::kNone; c = w_.next_child[c]) ++bones;
      for (size_t g = 0; g < goals_.size(); ++g) bones += goals_[g].joint == j && w_.lengths[n_ + g] > 0;
      if (bones > 1 || (bones == 1 && !(joints_[j].kind == JointKind::ball && unlimited(joints_[j]))))
        return false;
    }
    return true;
  }

  std::span<const Joint> joints_;
  std::span<const IkGoal> goals_;
  IkWork& w_;
  size_t n_;
  bool free_ = false;
};

}  // namespace

IkResult fabrik(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  using enum IkResult::End;
  constexpr double kProgress = 1e-6;  // of the error in an iteration; less is none
  double error = error_of(goals, w.poses);
  if (error <= options.tolerance) return {error, 0, reached};
  Fabrik chain(joints, goals, motion, w);
  if (chain.stretch()) {
    turn_to_places(joints, root, goals, motion, w);
    return {error_of(goals, w.poses), 1, stalled};
  }
  unstraighten(joints, root, goals, motion, w);
  chain.read_places();
  // With limits the way to the target may lead away from it for a while.
  const int patience = chain.free() ? 5 : 40;
  IkResult out{error, 0, exhausted};
  double best = error;
  int rests = 0;
  while (out.iterations < options.most) {
    chain.backward();
    chain.forward();
    ++out.iterations;
    if (chain.free()) {
      error = chain.error();
    } else {
      turn_to_places(joints, root, goals, motion, w);
      chain.read_places();
      error = error_of(goals, w.poses);
    }
    if (error <= options.tolerance) {
      out.end = reached;
      break;
    }
    rests = best - error < kProgress * best ? rests + 1 : 0;
    best = std::min(best, error);
    if (rests >= patience) {
      out.end = stalled;
      break;
    }
  }
  if (chain.free()) turn_to_places(joints, root, goals, motion, w);
  return out;
}

IkResult two_link(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  for (const IkGoal& g : goals) {
    // The joint after the base bends; what comes after it is as it is.
    uint32_t middle = g.joint;
    while (middle != g.base && joints[middle].parent != static_cast<int32_t>(g.base)) {
      middle = static_cast<uint32_t>(joints[middle].parent);
    }
    const Vec3 start = w.poses[g.base].position, bend = w.poses[middle].position - start;
    const double l1 = norm(bend), l2 = norm(end_of(g, w.poses) - w.poses[middle].position);
    const Vec3 line = g.target - start;
    const double d = std::clamp(norm(line), std::abs(l1 - l2), l1 + l2);
    if (!(d > 0) || !(l1 > 0) || !(l2 > 0)) continue;
    const Vec3 u = normalized(line, normalized(bend));
    Vec3 side = bend;
    if (g.pole) {
      side = *g.pole - start;
    } else if (joints[middle].kind == JointKind::revolute) {
      side = cross(u, freedom_axis(joints[middle], w.poses[middle], 0)) * options.elbow;
    }
    side = side - u * dot(u, side);
    const Vec3 any = std::abs(u.z) < 0.9 ? cross(u, Vec3{0, 0, 1}) : cross(u, Vec3{1, 0, 0});
    side = norm2(side) > 1e-24 * l1 * l1 ? normalized(side) : normalized(any);
    const double along = (l1 * l1 - l2 * l2 + d * d) / (2 * d);
    const double across = std::sqrt(std::max(0.0, (l1 - along) * (l1 + along)));
    aim(joints[g.base], w.poses[g.base], bend, u * along + side * across, motion[g.base]);
    forward_kinematics(joints, motion, root, w.poses);
    const Vec3 at = w.poses[middle].position;
    aim(joints[middle], w.poses[middle], end_of(g, w.poses) - at, g.target - at, motion[middle]);
    forward_kinematics(joints, motion, root, w.poses);
  }
  const double error = error_of(goals, w.poses);
  return {error, 1, error <= options.tolerance ? IkResult::End::reached : IkResult::End::stalled};
}

}  // namespace truestep::animation::ik
