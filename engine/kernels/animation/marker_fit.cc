#include "engine/kernels/animation/marker_fit.h"
#include "engine/math/solvers/small_cholesky.h"

#include <algorithm>
#include <cmath>

namespace truestep::animation {

namespace {

constexpr uint32_t kShift = 3;                // freedoms 3 to 5 of the first joint are its shift
constexpr double kSuspect = 6, kCut = 4.685;  // multiples of the spread; Tukey's c for 95 % efficiency
constexpr double kFinest = 1e-4;              // m, smallest spread
constexpr double kHeld = 1e-8;  // m^2: a radian from the start costs as much as a marker error of 0.1 mm

Vec3 axis_of(size_t k) {
  return {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
}

class Fit {
 public:
  Fit(std::span<const Joint> joints, std::span<const MarkerPlacement> markers, std::span<const Vec3> places,
      std::span<const uint8_t> seen, std::span<JointMotion> motion, MarkerWork& w)
      : joints_(joints), markers_(markers), places_(places), seen_(seen), motion_(motion), w_(w) {
    w.weights.assign(seen.begin(), seen.end());
    w.joint_of.clear(), w.freedom_of.clear();
    for (uint32_t k = 0; k < 3; ++k) w.joint_of.push_back(0), w.freedom_of.push_back(kShift + k);
    for (uint32_t j = 0; j < joints.size(); ++j) {
      for (uint32_t k = 0; k < freedoms(joints[j].kind); ++k)
        w.joint_of.push_back(j), w.freedom_of.push_back(k);
    }
    n_ = w.joint_of.size();
    w.normal.resize(n_ * n_), w.factor.resize(n_ * n_), w.gradient.resize(n_), w.step.resize(n_);
    w.column.resize(3 * n_), w.pulled.assign(n_, 0);
    w.poses.resize(joints.size()), w.tried_poses.resize(joints.size());
    w.tried.assign(motion.begin(), motion.end());
    forward_kinematics(joints, motion, {}, w.poses);
  }
  /// Restarts from the given pose.
  void restart(std::span<const JointMotion> at) {
    std::ranges::copy(at, motion_.begin());
    std::ranges::fill(w_.pulled, 0.0);
    forward_kinematics(joints_, motion_, {}, w_.poses);
  }
  /// m^2, sum of the squared distances measured, each limited to `most`.
  double cut_squares(double most) const {
    double sum = 0;
    for (size_t i = 0; i < markers_.size(); ++i) {
      if (seen_[i]) sum += std::min(w_.distances[i], most) * std::min(w_.distances[i], most);
    }
    return sum;
  }
  size_t freedoms_count() const { return n_; }

  double squares(std::span<const Pose> poses) const {
    double sum = 0;
    for (size_t i = 0; i < markers_.size(); ++i) {
      if (w_.weights[i] > 0) sum += w_.weights[i] * norm2(places_[i] - place(poses, i));
    }
    return sum;
  }
  /// J^T J and J^T r.
  void differentiate() {
    std::ranges::fill(w_.normal, 0.0);
    std::ranges::fill(w_.gradient, 0.0);
    for (size_t i = 0; i < markers_.size(); ++i) {
      const double weight = w_.weights[i];
      if (!(weight > 0)) continue;
      const Vec3 at = place(w_.poses, i), r = places_[i] - at;
      // Columns of the freedoms on the marker's chain, in order.
      on_way_.clear();
      for (size_t c = n_; c-- > 0;) {
        if (!is_above(w_.joint_of[c], markers_[i].joint)) continue;
        const Joint& joint = joints_[w_.joint_of[c]];
        const Pose& pose = w_.poses[w_.joint_of[c]];
        Vec3 move;
        if (w_.freedom_of[c] >= kShift) {
          move = rotate(joints_[0].rest.orientation, axis_of(w_.freedom_of[c] - kShift));
        } else {
          const Vec3 axis = freedom_axis(joint, pose, w_.freedom_of[c]);
          move = joint.kind == JointKind::prismatic ? axis : cross(axis, at - pose.position);
        }
        store3(w_.column.data(), c, move);
        on_way_.push_back(static_cast<uint32_t>(c));
        w_.gradient[c] += weight * dot(move, r);
      }
      for (const uint32_t a : on_way_) {
        const Vec3 ca = load3(w_.column.data(), a);
        for (const uint32_t b : on_way_) {
          if (b <= a) w_.normal[a * n_ + b] += weight * dot(ca, load3(w_.column.data(), b));
        }
      }
    }
    // w_.pulled holds the changes since the start of the fit.
    for (size_t c = 0; c < n_; ++c) {
      const double held = w_.freedom_of[c] >= kShift ? 1e-2 * kHeld : kHeld;
      w_.normal[c * n_ + c] += held, w_.gradient[c] -= held * w_.pulled[c];
    }
  }
  /// Measures the distances of all markers; returns the largest among those seen.
  double measure() {
    double most = 0;
    w_.distances.resize(markers_.size());
    for (size_t i = 0; i < markers_.size(); ++i) {
      w_.distances[i] = norm(places_[i] - place(w_.poses, i));
      if (seen_[i]) most = std::max(most, w_.distances[i]);
    }
    return most;
  }
  /// Spread of a coordinate from the median distance: the length of three normal numbers has the median
  /// 1.538.
  double spread() {
    w_.sorted.clear();
    for (size_t i = 0; i < markers_.size(); ++i) {
      if (seen_[i]) w_.sorted.push_back(w_.distances[i]);
    }
    const auto middle = w_.sorted.begin() + static_cast<ptrdiff_t>(w_.sorted.size() / 2);
    std::nth_element(w_.sorted.begin(), middle, w_.sorted.end());
    return std::max(w_.sorted.empty() ? 0 : *middle / 1.538, kFinest);
  }
  /// Sets the weights from the measured distances.
  template <class Weight>
  void weigh(Weight weight) {
    for (size_t i = 0; i < markers_.size(); ++i) w_.weights[i] = seen_[i] ? weight(w_.distances[i]) : 0;
  }

  double information(size_t c) const { return w_.normal[c * n_ + c] - kHeld; }

  /// Takes the damped step tentatively; returns the sum of squares after it.
  double attempt(double damping) {
    std::ranges::copy(w_.normal, w_.factor.begin());
    for (size_t c = 0; c < n_; ++c) w_.factor[c * n_ + c] *= 1 + damping;
    double* y = w_.step.data();
    std::ranges::copy(w_.gradient, w_.step.begin());
    cholesky_solve(w_.factor.data(), y, n_);
    constexpr double kLongest = 0.8;
    double most = 0;
    for (size_t c = 3; c < n_; ++c) most = std::max(most, std::abs(y[c]));
    if (most > kLongest) {
      for (size_t c = 3; c < n_; ++c) y[c] *= kLongest / most;
    }
    std::ranges::copy(motion_, w_.tried.begin());
    for (size_t c = 0; c < n_; ++c) {
      JointMotion& m = w_.tried[w_.joint_of[c]];
      if (w_.freedom_of[c] >= kShift) {
        (&m.shift.x)[w_.freedom_of[c] - kShift] += y[c];
      } else if (joints_[w_.joint_of[c]].kind == JointKind::ball) {
        m.turn = normalized(m.turn * free_rotation::turn({y[c], y[c + 1], y[c + 2]}));
        c += 2;
      } else {
        m.value += y[c];
      }
    }
    for (size_t j = 0; j < joints_.size(); ++j) apply_limits(joints_[j], w_.tried[j]);
    forward_kinematics(joints_, w_.tried, {}, w_.tried_poses);
    return squares(w_.tried_poses);
  }
  double accept() {
    double most = 0;
    for (size_t c = 0; c < n_; ++c) w_.pulled[c] += w_.step[c], most = std::max(most, std::abs(w_.step[c]));
    std::ranges::copy(w_.tried, motion_.begin());
    std::swap(w_.poses, w_.tried_poses);
    return most;
  }

 private:
  Vec3 place(std::span<const Pose> poses, size_t i) const {
    const Pose& p = poses[markers_[i].joint];
    return p.position + rotate(p.orientation, markers_[i].point);
  }
  bool is_above(uint32_t joint, uint32_t of) const {
    auto j = static_cast<int32_t>(of);
    while (j > static_cast<int32_t>(joint)) j = joints_[static_cast<size_t>(j)].parent;
    return j == static_cast<int32_t>(joint);
  }

  std::span<const Joint> joints_;
  std::span<const MarkerPlacement> markers_;
  std::span<const Vec3> places_;
  std::span<const uint8_t> seen_;
  std::span<JointMotion> motion_;
  MarkerWork& w_;
  size_t n_ = 0;
  std::vector<uint32_t> on_way_;
};

/// Levenberg-Marquardt from the present state of the fit; returns the final sum of squares.
double minimise(Fit& fit, MarkerWork& w, int most, int& iterations) {
  constexpr double kSettled = 1e-9;  // rad or m
  double e = fit.squares(w.poses), damping = 1e-3;
  bool settled = false;
  for (int round = 0; round < most && !settled; ++round) {
    fit.differentiate();
    ++iterations;
    settled = true;
    for (int k = 0; k < 12; ++k) {
      const double after = fit.attempt(damping);
      if (after < e) {
        settled = fit.accept() < kSettled || e - after < 1e-12 * e;
        e = after, damping = std::max(0.1 * damping, 1e-12);
        break;
      }
      damping *= 10;
    }
  }
  return e;
}

constexpr int kMost = 100;

/// Refits from the present state without markers that are too far off; returns the final sum of squares.
double set_outliers_aside(Fit& fit, MarkerWork& w, int& iterations) {
  constexpr int kRounds = 60;
  double c = fit.measure();
  for (int k = 0; k < kRounds; ++k) {
    fit.weigh([c](double r) {
      const double x = 1 - (r / c) * (r / c);
      return x > 0 ? x * x : 0;
    });
    minimise(fit, w, 10, iterations);
    fit.measure();
    const double least = kCut * fit.spread();
    if (c <= least) break;
    c = std::max(0.8 * c, least);
  }
  double e = 0;
  for (int k = 0; k < 2; ++k) {
    const double cut = kCut * fit.spread();
    fit.weigh([cut](double r) { return r <= cut ? 1.0 : 0.0; });
    e = minimise(fit, w, kMost, iterations);
    fit.measure();
  }
  return e;
}

/// The better of two such fits: from the given pose, which is good if the previous frame was, and from the
/// fit to all markers, which needs no previous frame.
double fit_without_outliers(Fit& fit, MarkerWork& w, std::span<const JointMotion> motion, int& iterations) {
  const std::vector<JointMotion> all(motion.begin(), motion.end());
  fit.restart(w.start);
  double e = set_outliers_aside(fit, w, iterations);
  const double spread = fit.spread();
  const std::vector<JointMotion> first(motion.begin(), motion.end());
  const std::vector<double> weights = w.weights, distances = w.distances;
  fit.restart(all);
  const double other = set_outliers_aside(fit, w, iterations);
  const double most = kCut * std::min(spread, fit.spread()), squares = fit.cut_squares(most);
  w.distances = distances;
  if (fit.cut_squares(most) > squares) return other;
  fit.restart(first);
  w.weights = weights;
  return e;
}

}  // namespace

MarkerFit fit_markers(std::span<const Joint> joints, std::span<const MarkerPlacement> markers,
                      std::span<const Vec3> places, std::span<const uint8_t> seen,
                      std::span<JointMotion> motion, std::span<uint8_t> known, MarkerWork& w) {
  w.start.assign(motion.begin(), motion.end());
  Fit fit(joints, markers, places, seen, motion, w);
  MarkerFit out;
  double e = minimise(fit, w, kMost, out.iterations);
  const double farthest = fit.measure();
  if (farthest > kSuspect * fit.spread()) {
    e = fit_without_outliers(fit, w, motion, out.iterations);
    fit.measure();
  }
  out.spread = fit.spread();
  fit.differentiate();
  constexpr double kTold = 1e-6;  // m^2: a radian moves a marker by a millimetre
  std::ranges::fill(known, uint8_t{0});
  for (size_t c = 0; c < fit.freedoms_count(); ++c) {
    if (w.freedom_of[c] < kShift && fit.information(c) > kTold) known[w.joint_of[c]] = 1;
  }
  size_t count = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    count += w.weights[i] > 0;
    out.outliers += seen[i] && !(w.weights[i] > 0);
  }
  out.error = count > 0 ? std::sqrt(e / static_cast<double>(count)) : 0;
  return out;
}

}  // namespace truestep::animation
