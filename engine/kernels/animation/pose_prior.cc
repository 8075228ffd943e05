#include "engine/kernels/animation/pose_prior.h"

#include <algorithm>
#include <cmath>

#include "engine/math/solvers/dense_symmetric.h"
#include "engine/math/solvers/small_cholesky.h"

namespace truestep::animation {

using free_rotation::rotation_vector;
using free_rotation::turn;

namespace {

/// Fixed-point iteration for the mean of the rotation vectors, starting at the first pose's rotation.
Quat mean_turn(std::span<const JointMotion> poses, size_t joints, size_t joint) {
  Quat mean = poses[joint].turn;
  const size_t frames = poses.size() / joints;
  for (int k = 0; k < 20; ++k) {
    Vec3 off;
    for (size_t f = 0; f < frames; ++f)
      off += rotation_vector(conjugate(mean) * poses[f * joints + joint].turn);
    off = off / static_cast<double>(frames);
    mean = normalized(mean * turn(off));
    if (norm(off) < 1e-12) break;
  }
  return mean;
}

/// Column k of the derivative of a rotation, taken as a rotation in the joint's own frame, with respect to
/// its rotation vector x: the right Jacobian I - (1 - cos a)/a^2 [x] + (a - sin a)/a^3 [x]^2, a = |x|.
Vec3 right_jacobian_column(const Vec3& x, size_t k) {
  const Vec3 e{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
  const double a2 = norm2(x), a = std::sqrt(a2);
  double first = 0.5 - a2 / 24, second = 1.0 / 6 - a2 / 120;
  if (a > 1e-3) {
    const auto [sine, cosine] = trig::sincos(a);
    first = (1 - cosine) / a2, second = (a - sine) / (a2 * a);
  }
  const Vec3 once = cross(x, e);
  return e - once * first + cross(x, once) * second;
}

}  // namespace

PosePrior::PosePrior(std::span<const Joint> joints, std::span<const JointMotion> poses,
                     std::span<const uint8_t> known, size_t components, double least) {
  const size_t n = joints.size(), frames = poses.size() / n;
  for (uint32_t j = 0; j < n; ++j) {
    kinds_.push_back(joints[j].kind);
    if (!known[j] || joints[j].kind == JointKind::fixed) continue;
    Coordinate c{j, size_, {}, 0};
    if (joints[j].kind == JointKind::ball) {
      c.mean_turn = mean_turn(poses, n, j), size_ += 3;
    } else {
      for (size_t f = 0; f < frames; ++f)
        c.mean_value += poses[f * n + j].value / static_cast<double>(frames);
      size_ += 1;
    }
    coordinates_.push_back(c);
  }
  if (size_ == 0) return;
  DenseColumns samples(size_, frames);
  for (size_t f = 0; f < frames; ++f) read(poses.subspan(f * n, n), samples.column(f).data());
  const PrincipalComponents found = principal_components(samples);
  const auto& [variances, axes] = found.of_covariance;
  const double all = std::max(found.trace, 1e-300);
  const size_t count = std::min(components, size_);
  double held = 0;
  for (size_t k = 0; k < count; ++k) {
    const size_t c = size_ - 1 - k;
    const double variance = std::max(variances[c], 0.0);
    held += variance;
    deviations_.push_back(std::max(std::sqrt(variance), least));
    for (size_t i = 0; i < size_; ++i) components_.push_back(axes(i, c));
  }
  explained_ = std::min(held / all, 1.0);
  const double left = count < size_ ? std::max(all - held, 0.0) / static_cast<double>(size_ - count) : 0;
  rest_ = std::max(std::sqrt(left), least);
}

void PosePrior::read(std::span<const JointMotion> motion, double* x) const {
  for (const Coordinate& c : coordinates_) {
    if (kinds_[c.joint] == JointKind::ball) {
      const Vec3 v = rotation_vector(conjugate(c.mean_turn) * motion[c.joint].turn);
      x[c.first] = v.x, x[c.first + 1] = v.y, x[c.first + 2] = v.z;
    } else {
      x[c.first] = motion[c.joint].value - c.mean_value;
    }
  }
}

void PosePrior::write(const double* x, std::span<JointMotion> motion) const {
  for (const Coordinate& c : coordinates_) {
    if (kinds_[c.joint] == JointKind::ball) {
      motion[c.joint].turn = normalized(c.mean_turn * turn({x[c.first], x[c.first + 1], x[c.first + 2]}));
    } else {
      motion[c.joint].value = c.mean_value + x[c.first];
    }
  }
}

void PosePrior::set_mean(std::span<JointMotion> motion) const {
  for (const Coordinate& c : coordinates_) {
    if (kinds_[c.joint] == JointKind::ball) {
      motion[c.joint].turn = c.mean_turn;
    } else {
      motion[c.joint].value = c.mean_value;
    }
  }
}

void PosePrior::spread_out(const double* v, double* out) const {
  for (size_t i = 0; i < size_; ++i) out[i] = rest_ * rest_ * v[i];
  for (size_t k = 0; k < deviations_.size(); ++k) {
    const double* u = &components_[k * size_];
    double along = 0;
    for (size_t i = 0; i < size_; ++i) along += u[i] * v[i];
    along *= deviations_[k] * deviations_[k] - rest_ * rest_;
    for (size_t i = 0; i < size_; ++i) out[i] += along * u[i];
  }
}

double PosePrior::energy(const double* x) const {
  double sum = 0;
  for (size_t i = 0; i < size_; ++i) sum += x[i] * x[i] / (rest_ * rest_);
  for (size_t k = 0; k < deviations_.size(); ++k) {
    const double* u = &components_[k * size_];
    double along = 0;
    for (size_t i = 0; i < size_; ++i) along += u[i] * x[i];
    sum += along * along * (1 / (deviations_[k] * deviations_[k]) - 1 / (rest_ * rest_));
  }
  return std::max(sum, 0.0);
}

double PosePrior::distance(std::span<const JointMotion> motion, std::vector<double>& scratch) const {
  if (size_ == 0) return 0;
  scratch.resize(size_);
  read(motion, scratch.data());
  return std::sqrt(energy(scratch.data()) / static_cast<double>(size_));
}

namespace {

/// Weighted residuals of all goals; returns their squared length.
double residual_of(std::span<const IkGoal> goals, std::span<const Pose> poses, double* r) {
  double sum = 0;
  for (const IkGoal& g : goals) {
    const Pose& end = poses[g.joint];
    const Vec3 off = (g.target - end.position - rotate(end.orientation, g.point)) * g.weight;
    store3(r, 0, off), sum += norm2(off);
    if (g.orientation) {
      const Vec3 left =
          rotation_vector(*g.orientation * conjugate(end.orientation)) * (g.weight * g.orientation_weight);
      store3(r, 1, left), sum += norm2(left);
    }
    r += ik_rows(g);
  }
  return sum;
}

}  // namespace

IkResult PosePrior::descend(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                            double spread, int most, std::span<JointMotion> motion, IkWork& ik,
                            Work& w) const {
  using enum IkResult::End;
  constexpr double kShrink = 0.3;    // spread as a fraction of the error
  constexpr double kSettled = 1e-7;  // rad or m, change of x per iteration
  size_t rows = 0;
  for (const IkGoal& g : goals) rows += ik_rows(g);
  w.x.resize(size_), w.target.resize(size_), w.tried.resize(size_), w.jacobian.resize(rows * size_);
  w.projected.resize(rows * size_), w.gram.resize(rows * rows), w.residual.resize(rows),
      w.spread.resize(rows);
  w.motion.assign(motion.begin(), motion.end());
  ik.poses.resize(joints.size());
  const auto limit = [&](std::span<JointMotion> m) {
    for (const Coordinate& c : coordinates_) apply_limits(joints[c.joint], m[c.joint]);
  };
  forward_kinematics(joints, motion, root, ik.poses);
  IkResult out;
  out.end = exhausted;
  for (; out.iterations < most; ++out.iterations) {
    read(motion, w.x.data());
    const double error = std::sqrt(residual_of(goals, ik.poses, w.residual.data()));
    const double loose = std::max(spread, kShrink * error), variance = loose * loose;
    // Columns: derivatives with respect to rotation vectors and values.
    size_t row = 0;
    std::ranges::fill(w.jacobian, 0.0);
    for (const IkGoal& g : goals) {
      const Pose& end = ik.poses[g.joint];
      const Vec3 place = end.position + rotate(end.orientation, g.point);
      for (size_t i = coordinates_.size(); i-- > 0;) {
        const Coordinate& c = coordinates_[i];
        // Only joints on the goal's chain, from its base on.
        auto j = static_cast<int32_t>(g.joint);
        while (j > static_cast<int32_t>(c.joint)) j = joints[static_cast<size_t>(j)].parent;
        if (j != static_cast<int32_t>(c.joint) || c.joint < g.base) continue;
        const Joint& joint = joints[c.joint];
        const Pose& pose = ik.poses[c.joint];
        const bool ball = joint.kind == JointKind::ball, slides = joint.kind == JointKind::prismatic;
        const Vec3 x = ball ? Vec3{w.x[c.first], w.x[c.first + 1], w.x[c.first + 2]} : Vec3{};
        for (size_t k = 0; k < freedoms(joint.kind); ++k) {
          const Vec3 axis =
              ball ? rotate(pose.orientation, right_jacobian_column(x, k)) : freedom_axis(joint, pose, k);
          const Vec3 move = (slides ? axis : cross(axis, place - pose.position)) * g.weight;
          for (size_t d = 0; d < 3; ++d) w.jacobian[(row + d) * size_ + c.first + k] = (&move.x)[d];
          if (!g.orientation || slides) continue;
          for (size_t d = 0; d < 3; ++d)
            w.jacobian[(row + 3 + d) * size_ + c.first + k] = (&axis.x)[d] * g.weight * g.orientation_weight;
        }
      }
      row += ik_rows(g);
    }
    for (size_t r = 0; r < rows; ++r) {
      const double* line = &w.jacobian[r * size_];
      spread_out(line, &w.projected[r * size_]);
      double along = w.residual[r];
      for (size_t i = 0; i < size_; ++i) along += line[i] * w.x[i];
      w.spread[r] = along;
    }
    for (size_t r = 0; r < rows; ++r) {
      for (size_t c = 0; c <= r; ++c) {
        double sum = r == c ? variance : 0;
        for (size_t i = 0; i < size_; ++i) sum += w.jacobian[r * size_ + i] * w.projected[c * size_ + i];
        w.gram[r * rows + c] = sum;
      }
    }
    cholesky_solve(w.gram.data(), w.spread.data(), rows);
    std::ranges::fill(w.target, 0.0);
    for (size_t r = 0; r < rows; ++r) {
      for (size_t i = 0; i < size_; ++i) w.target[i] += w.spread[r] * w.projected[r * size_ + i];
    }
    const double before = error * error / variance + energy(w.x.data());
    double share = 1, moved = 0;
    bool gained = false;
    for (int half = 0; half < 12 && !gained; ++half, share *= 0.5) {
      moved = 0;
      for (size_t i = 0; i < size_; ++i) {
        const double by = share * (w.target[i] - w.x[i]);
        w.tried[i] = w.x[i] + by, moved = std::max(moved, std::abs(by));
      }
      write(w.tried.data(), w.motion);
      limit(w.motion);
      forward_kinematics(joints, w.motion, root, ik.poses);
      read(w.motion, w.tried.data());
      const double sum = residual_of(goals, ik.poses, w.residual.data());
      gained = sum / variance + energy(w.tried.data()) < before;
    }
    if (gained) std::copy(w.motion.begin(), w.motion.end(), motion.begin());
    if (!gained || (moved < kSettled && loose <= spread)) {
      out.end = stalled, ++out.iterations;
      break;
    }
  }
  forward_kinematics(joints, motion, root, ik.poses);
  out.error = ik::error_of(goals, ik.poses);
  return out;
}

IkResult PosePrior::solve(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                          double spread, int most, std::span<JointMotion> motion, IkWork& ik, Work& w) const {
  constexpr double kNatural = 2;  // deviations
  constexpr size_t kComponents = 2;
  const auto cost = [&](const IkResult& r) {
    read(motion, w.x.data());
    return r.error * r.error / (spread * spread) + energy(w.x.data());
  };
  w.start.assign(motion.begin(), motion.end());
  IkResult out = descend(joints, root, goals, spread, most, motion, ik, w);
  double least = cost(out);
  if (least < kNatural * kNatural * static_cast<double>(size_)) return out;
  w.best.assign(motion.begin(), motion.end());
  const auto others = static_cast<int>(2 * std::min(kComponents, deviations_.size()));
  for (int k = 0; k <= others; ++k) {
    std::copy(w.start.begin(), w.start.end(), motion.begin());
    std::ranges::fill(w.x, 0.0);
    for (size_t i = 0; k > 0 && i < size_; ++i) {
      const auto c = static_cast<size_t>((k - 1) / 2);
      w.x[i] = (k % 2 == 0 ? -1 : 1) * 1.5 * deviations_[c] * components_[c * size_ + i];
    }
    write(w.x.data(), motion);
    for (const Coordinate& c : coordinates_) apply_limits(joints[c.joint], motion[c.joint]);
    const IkResult r = descend(joints, root, goals, spread, most, motion, ik, w);
    out.iterations += r.iterations;
    const double here = cost(r);
    if (!(here < least)) continue;
    least = here, out.error = r.error, out.end = r.end;
    std::copy(motion.begin(), motion.end(), w.best.begin());
  }
  std::copy(w.best.begin(), w.best.end(), motion.begin());
  forward_kinematics(joints, motion, root, ik.poses);
  return out;
}

}  // namespace truestep::animation
