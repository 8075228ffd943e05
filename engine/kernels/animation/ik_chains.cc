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

/// Slightly bends chains that lie on the line to their targets, which they would otherwise never leave.
void unstraighten(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  std::span<JointMotion> motion, IkWork& w) {
  constexpr double kStraight = 1e-7, kHair = 1e-3;  // fraction of the distance to the target; rad
  bool bent = false;
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
    bent = true;
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
  if (bent) forward_kinematics(joints, motion, root, w.poses);
}

}  // namespace

IkResult ccd(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
             const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  using enum IkResult::End;
  constexpr double kProgress = 1e-7;  // of the error; a smaller gain per iteration is none
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
    single_ = free_ && goals.size() == 1;
  }
  bool free() const { return free_; }
  bool is_base(size_t j) const {
    return joints_[j].parent < 0 || !w_.moves[static_cast<size_t>(joints_[j].parent)];
  }

  /// One goal at the end of one chain of unlimited ball joints, whose positions then form a single row.
  bool single() const { return single_; }

  void read_places() {
    for (const uint32_t j : w_.path) w_.places[j] = w_.poses[j].position;
    for (size_t g = 0; g < goals_.size(); ++g) w_.places[n_ + g] = end_of(goals_[g], w_.poses);
  }
  double error() const {
    double e = 0;
    for (size_t g = 0; g < goals_.size(); ++g) e = std::max(e, norm(w_.places[end(g)] - goals_[g].target));
    return e;
  }
  /// From the targets to the bases: every joint is placed at its bone's length from the next one.
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
  /// From the bases, which are fixed, to the ends.
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
  /// Points a chain that cannot reach its target straight at it; false if the chain can reach it.
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
  /// Whether joint rotations exist for any positions at the bones' lengths: ball joints without limits, with
  /// one bone on each.
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
  bool free_ = false, single_ = false;
};

}  // namespace

namespace {

/// FABRIK on one chain of unlimited ball joints. Plain passes converge by a factor that tends to 1 with the
/// number of joints; their target is therefore moved beyond the true one,
///   t' = t + (w - 1) e,   e = t - end,   w <- -w e_before . (e - e_before) / |e - e_before|^2 in [1, 20]
/// (Aitken's relaxation of vector fixed points, Irons, Tuck 1969), for as long as that helps.
class FreeChain {
 public:
  /// Positions of the joints from the base on and of the end; lengths of the links that lead to each but the
  /// first.
  FreeChain(std::span<Vec3> places, std::span<const double> lengths, std::span<double> inverse_squares)
      : x_(places), lengths_(lengths), inverse_squares_(inverse_squares), base_(places[0]) {
    for (size_t k = 1; k < x_.size(); ++k) {
      inverse_squares_[k] = lengths_[k] > 0 ? 1 / (lengths_[k] * lengths_[k]) : 0;
    }
  }
  /// One backward and one forward pass; returns the remaining distance to the target.
  double pass(const Vec3& target) {
    const size_t last = x_.size() - 1;
    Vec3 p = target + ahead_;
    for (size_t k = last; k-- > 0;) x_[k] = p = at_length(p, x_[k], k + 1);
    x_[0] = p = base_;
    for (size_t k = 1; k < last; ++k) x_[k] = p = at_length(p, x_[k], k);
    x_[last] = at_length(p, target + ahead_, last);
    const Vec3 e = target - x_[last];
    relax(e);
    return norm(e);
  }

 private:
  void relax(const Vec3& e) {
    constexpr double kMostAhead = 20;
    constexpr int kPatience = 3;
    const double now = norm2(e);
    if (now >= best_) ++useless_;
    best_ = std::min(best_, now);
    if (useless_ >= kPatience) {
      ahead_ = {};
      return;
    }
    if (passes_++ > 0) {
      const Vec3 d = e - before_;
      const double dd = norm2(d);
      w_ = now > norm2(before_) || !(dd > 0) ? 1 : std::clamp(-w_ * dot(before_, d) / dd, 1.0, kMostAhead);
    }
    ahead_ = e * (w_ - 1), before_ = e;
  }
  /// The point at the length of link k from a point in the direction of another. Links nearly have their
  /// lengths: with |d|^2 = length^2 (1 + e), a few terms of 1 / sqrt(1 + e) avoid the square root and the
  /// division that the next link would have to wait for. The error is 0.25 e^4.
  Vec3 at_length(const Vec3& from, const Vec3& towards, size_t k) const {
    constexpr double kSeries = 1e-3;
    const Vec3 d = towards - from;
    const double squared = std::fma(d.x, d.x, std::fma(d.y, d.y, d.z * d.z));
    const double e = std::fma(squared, inverse_squares_[k], -1.0);
    double f;
    if (std::abs(e) < kSeries) {
      f = std::fma(e * e, std::fma(-0.3125, e, 0.375), std::fma(-0.5, e, 1.0));
    } else if (squared > 0) {
      f = lengths_[k] / std::sqrt(squared);
    } else {
      return from + Vec3{0, lengths_[k], 0};
    }
    return {std::fma(d.x, f, from.x), std::fma(d.y, f, from.y), std::fma(d.z, f, from.z)};
  }

  std::span<Vec3> x_;
  std::span<const double> lengths_;
  std::span<double> inverse_squares_;
  Vec3 base_, ahead_, before_;
  double w_ = 1, best_ = HUGE_VAL;
  int passes_ = 0, useless_ = 0;
};

/// Copies lengths and positions into one row, from the base of the goal to its end.
size_t put_in_row(std::span<const Joint> joints, const IkGoal& g, IkWork& w) {
  const size_t n = joints.size();
  w.row.clear();
  const bool has_end = w.lengths[n] > 0;
  if (has_end) w.row.push_back(static_cast<uint32_t>(n));
  for (auto j = static_cast<int32_t>(g.joint);; j = joints[static_cast<size_t>(j)].parent) {
    w.row.push_back(static_cast<uint32_t>(j));
    if (static_cast<size_t>(j) == g.base) break;
  }
  std::ranges::reverse(w.row);
  const size_t count = w.row.size();
  w.row_places.resize(count), w.row_lengths.resize(2 * count);
  for (size_t k = 0; k < count; ++k) {
    w.row_places[k] = w.places[w.row[k]], w.row_lengths[k] = k > 0 ? w.lengths[w.row[k]] : 0;
  }
  return count;
}

}  // namespace

IkResult fabrik(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  using enum IkResult::End;
  constexpr double kProgress = 1e-6;  // of the error; a smaller gain per iteration is none
  double error = error_of(goals, w.poses);
  if (error <= options.tolerance) return {error, 0, reached};
  Fabrik chain(joints, goals, motion, w);
  if (chain.stretch()) {
    turn_to_places(joints, root, goals, motion, w);
    return {error_of(goals, w.poses), 1, stalled};
  }
  unstraighten(joints, root, goals, motion, w);
  chain.read_places();
  // With limits, the error may have to grow for a while before it falls.
  const int patience = chain.free() ? 5 : 40;
  IkResult out{error, 0, exhausted};
  double best = error;
  int rests = 0;
  std::optional<FreeChain> row;
  if (chain.single()) {
    const size_t count = put_in_row(joints, goals[0], w);
    if (count > 1)
      row.emplace(w.row_places, std::span(w.row_lengths).first(count), std::span(w.row_lengths).last(count));
  }
  while (out.iterations < options.most) {
    if (!row) {
      chain.backward();
      chain.forward();
    }
    ++out.iterations;
    if (row) {
      error = row->pass(goals[0].target);
    } else if (chain.free()) {
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
  if (row) {
    for (size_t k = 0; k < w.row.size(); ++k) w.places[w.row[k]] = w.row_places[k];
  }
  if (chain.free()) turn_to_places(joints, root, goals, motion, w);
  return out;
}

IkResult two_link(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  for (const IkGoal& g : goals) {
    // The joint after the base bends; the joints after it keep their angles.
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
