// Solvers that follow the derivatives of E = 1/2 |r|^2: gradient descent, Gauss-Newton, damped least squares.
// Where a single E is needed, goals count 1e-4 times as much per level of lower priority; their steps are
// taken in the null space of the levels above.
#include <algorithm>
#include <cmath>

#include "engine/kernels/animation/inverse_kinematics.h"
#include "engine/math/solvers/small_cholesky.h"

namespace truestep::animation::ik {

namespace {

constexpr double kLongestTurn = 0.8;  // rad (or m, of a slide): largest change of a freedom per iteration
constexpr double kLevel = 1e-4;

double dot_rows(const double* a, const double* b, size_t n) {
  double s[4] = {};
  size_t k = 0;
  for (; k + 4 <= n; k += 4) {
    for (size_t i = 0; i < 4; ++i) s[i] += a[k + i] * b[k + i];
  }
  for (; k < n; ++k) s[0] += a[k] * b[k];
  return (s[0] + s[1]) + (s[2] + s[3]);
}

class LeastSquares {
 public:
  LeastSquares(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
               std::span<JointMotion> motion, IkWork& w)
      : joints_(joints), root_(root), goals_(goals), motion_(motion), w_(w), n_(w.joint_of.size()) {
    for (const IkGoal& g : goals) rows_ += ik_rows(g);
    w_.residual.resize(2 * rows_);
    w_.step.resize(n_);
    w_.frozen.resize(n_);
    w_.gram.resize(rows_ * (rows_ + 1));
    w_.projected.resize(rows_ * n_);
    w_.basis.resize(rows_ * n_);
  }

  /// E at the given poses; fills the residual r.
  double residual(std::span<const Pose> poses, double* r) const {
    double sum = 0;
    for (const IkGoal& g : goals_) {
      const Pose& end = poses[g.joint];
      const double level = level_weight(g);
      const Vec3 off = (g.target - end.position - rotate(end.orientation, g.point)) * g.weight;
      store3(r, 0, off);
      sum += level * norm2(off);
      if (g.orientation) {
        const Vec3 turn = free_rotation::rotation_vector(*g.orientation * conjugate(end.orientation)) *
                          (g.weight * g.orientation_weight);
        store3(r, 1, turn);
        sum += level * norm2(turn);
      }
      r += ik_rows(g);
    }
    return 0.5 * sum;
  }
  double look() { return residual(w_.poses, w_.residual.data()); }
  void differentiate() { ik_jacobian(joints_, goals_, w_); }

  /// Sets the step to J^T r without the blocked freedoms; returns its squared length.
  double descent() {
    std::fill(w_.step.begin(), w_.step.end(), 0.0);
    size_t row = 0;
    for (const IkGoal& g : goals_) {
      for (size_t k = 0; k < ik_rows(g); ++k, ++row) add_row(row, level_weight(g) * w_.residual[row]);
    }
    double sum = 0;
    for (size_t c = 0; c < n_; ++c) {
      if (is_blocked(c, w_.step[c])) w_.step[c] = 0;
      sum += w_.step[c] * w_.step[c];
    }
    return sum;
  }
  /// |J step|^2, weighted by level.
  double curvature() const {
    double sum = 0;
    size_t row = 0;
    for (const IkGoal& g : goals_) {
      for (size_t k = 0; k < ik_rows(g); ++k, ++row) {
        const double d = dot_rows(&w_.jacobian[row * n_], w_.step.data(), n_);
        sum += level_weight(g) * d * d;
      }
    }
    return sum;
  }
  double largest_gram() const {
    double most = 0;
    for (size_t r = 0; r < rows_; ++r) {
      most = std::max(most, dot_rows(&w_.jacobian[r * n_], &w_.jacobian[r * n_], n_));
    }
    return most;
  }

  /// Damped least-squares step of all levels; freedoms blocked by a limit are left out.
  void solve(double damping) {
    std::fill(w_.frozen.begin(), w_.frozen.end(), uint8_t{0});
    for (int round = 0; round < 4; ++round) {
      solve_levels(damping);
      bool more = false;
      for (size_t c = 0; c < n_; ++c) {
        if (w_.frozen[c] || w_.step[c] == 0 || !is_blocked(c, w_.step[c])) continue;
        more = true, w_.frozen[c] = 1, w_.step[c] = 0;
        for (size_t r = 0; r < rows_; ++r) w_.jacobian[r * n_ + c] = 0;
      }
      if (!more) return;
    }
  }
  void shorten() {
    double most = 0;
    for (const double s : w_.step) most = std::max(most, std::abs(s));
    if (most > kLongestTurn) scale(kLongestTurn / most);
  }
  void scale(double by) {
    for (double& s : w_.step) s *= by;
  }
  /// Predicted E after the step, with r taken as linear.
  double promised() const {
    double sum = 0;
    size_t row = 0;
    for (const IkGoal& g : goals_) {
      for (size_t k = 0; k < ik_rows(g); ++k, ++row) {
        const double r = w_.residual[row] - dot_rows(&w_.jacobian[row * n_], w_.step.data(), n_);
        sum += level_weight(g) * r * r;
      }
    }
    return 0.5 * sum;
  }
  /// Takes the step tentatively and returns E after it.
  double attempt() {
    std::copy(motion_.begin(), motion_.end(), w_.tried.begin());
    for (size_t c = 0; c < n_; ++c) {
      const uint32_t j = w_.joint_of[c];
      JointMotion& m = w_.tried[j];
      if (joints_[j].kind == JointKind::ball) {
        m.turn = normalized(m.turn * free_rotation::turn({w_.step[c], w_.step[c + 1], w_.step[c + 2]}));
        c += 2;
      } else {
        m.value += w_.step[c];
      }
      apply_limits(joints_[j], m);
    }
    forward_kinematics(joints_, w_.tried, root_, w_.tried_poses);
    return residual(w_.tried_poses, w_.residual.data() + rows_);
  }
  void accept() {
    std::copy(w_.tried.begin(), w_.tried.end(), motion_.begin());
    std::swap(w_.poses, w_.tried_poses);
    std::copy_n(w_.residual.data() + rows_, rows_, w_.residual.data());
  }
  /// A small step away from a point where no freedom helps to first order, such as a straight arm that should
  /// fold.
  void nudge() {
    double by = 1e-3;
    for (size_t c = 0; c < n_; ++c, by = -by) w_.step[c] = by * static_cast<double>(1 + c % 3);
    attempt();
    accept();
  }
  double error() const { return error_of(goals_, w_.poses); }

 private:
  static double level_weight(const IkGoal& g) {
    double w = 1;
    for (int k = 0; k < g.priority; ++k) w *= kLevel;
    return w;
  }
  bool is_blocked(size_t c, double by) const {
    const uint32_t j = w_.joint_of[c];
    return by != 0 && blocked(joints_[j], motion_[j], w_.freedom_of[c], by);
  }
  void add_row(size_t row, double by) {
    for (size_t c = 0; c < n_; ++c) w_.step[c] += by * w_.jacobian[row * n_ + c];
  }

  void solve_levels(double damping) {
    std::fill(w_.step.begin(), w_.step.end(), 0.0);
    kept_ = 0;
    size_t first = 0, goal = 0;
    while (goal < goals_.size()) {
      const int priority = goals_[goal].priority;
      size_t count = 0;
      for (; goal < goals_.size() && goals_[goal].priority == priority; ++goal)
        count += ik_rows(goals_[goal]);
      solve_level(first, count, damping);
      if (goal < goals_.size()) keep(count);
      first += count;
    }
  }
  // step += J'^T (J' J'^T + damping)^-1 (r - J step), where J' is J projected onto the null space of the
  // earlier levels.
  void solve_level(size_t first, size_t count, double damping) {
    double *a = w_.gram.data(), *y = a + count * count;
    for (size_t r = 0; r < count; ++r) {
      const double* row = &w_.jacobian[(first + r) * n_];
      double* out = &w_.projected[r * n_];
      std::copy_n(row, n_, out);
      for (size_t k = 0; k < kept_; ++k) {
        const double* q = &w_.basis[k * n_];
        const double d = dot_rows(q, out, n_);
        for (size_t c = 0; c < n_; ++c) out[c] -= d * q[c];
      }
      y[r] = w_.residual[first + r] - dot_rows(row, w_.step.data(), n_);
    }
    double trace = 0;
    for (size_t r = 0; r < count; ++r) {
      for (size_t c = 0; c <= r; ++c)
        a[r * count + c] = dot_rows(&w_.projected[r * n_], &w_.projected[c * n_], n_);
      trace += a[r * count + r];
    }
    // Dependent rows must not contribute; and the part of a later level outside the earlier ones may be tiny,
    // where following it would consume the whole step.
    constexpr double kFloor = 1e-12, kLaterFloor = 1e-2;  // fractions of the sum of squares of the rows
    double rows = 0;
    for (size_t r = 0; first > 0 && r < count; ++r) {
      const double* row = &w_.jacobian[(first + r) * n_];
      rows += dot_rows(row, row, n_);
    }
    const double floor = std::max(damping, kLaterFloor * rows) + kFloor * trace + 1e-300;
    for (size_t r = 0; r < count; ++r) a[r * count + r] += floor;
    cholesky_solve(a, y, count);
    for (size_t r = 0; r < count; ++r) {
      const double* row = &w_.projected[r * n_];
      for (size_t c = 0; c < n_; ++c) w_.step[c] += y[r] * row[c];
    }
  }
  /// Orthonormalizes the rows of this level and adds them to the basis that later levels must not change.
  void keep(size_t count) {
    constexpr double kDependent = 1e-8;
    for (size_t r = 0; r < count; ++r) {
      double* q = &w_.basis[kept_ * n_];
      std::copy_n(&w_.projected[r * n_], n_, q);
      const double before = dot_rows(q, q, n_);
      for (int twice = 0; twice < 2; ++twice) {
        for (size_t k = 0; k < kept_; ++k) {
          const double* p = &w_.basis[k * n_];
          const double d = dot_rows(p, q, n_);
          for (size_t c = 0; c < n_; ++c) q[c] -= d * p[c];
        }
      }
      const double after = dot_rows(q, q, n_);
      if (!(after > kDependent * kDependent * before) || !(after > 0)) continue;
      const double scale = 1 / std::sqrt(after);
      for (size_t c = 0; c < n_; ++c) q[c] *= scale;
      ++kept_;
    }
  }

  std::span<const Joint> joints_;
  const Pose& root_;
  std::span<const IkGoal> goals_;
  std::span<JointMotion> motion_;
  IkWork& w_;
  size_t n_, rows_ = 0, kept_ = 0;
};

/// Backtracking line search along the step; false if E cannot be reduced.
bool search(LeastSquares& s, double& e, double slope) {
  constexpr double kArmijo = 1e-4;
  for (int k = 0; k < 20; ++k) {
    const double after = s.attempt();
    if (after <= e - kArmijo * slope && after < e) {
      s.accept();
      e = after;
      return true;
    }
    s.scale(0.5), slope *= 0.5;
  }
  return false;
}

}  // namespace

IkResult least_squares(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                       const IkOptions& options, std::span<JointMotion> motion, IkWork& w) {
  using enum IkResult::End;
  constexpr double kProgress = 1e-9;  // of E; a smaller gain per iteration is none
  LeastSquares s(joints, root, goals, motion, w);
  double e = s.look(), damping = -1, growth = 2;
  int rests = 0, nudges = 0;
  IkResult out;
  for (; out.iterations < options.most; ++out.iterations) {
    out.error = s.error();
    if (out.error <= options.tolerance) return out;
    const double before = e;
    bool gained = false, settled = true;
    s.differentiate();
    if (options.method == IkMethod::gradient) {
      const double g = s.descent(), bend = s.curvature();
      if (g > 0 && bend > 0) {
        s.scale(g / bend);
        gained = search(s, e, g * g / bend);
      }
    } else if (options.method == IkMethod::gauss_newton) {
      s.solve(0);
      s.shorten();
      gained = search(s, e, 0);
    } else {
      if (damping < 0) damping = 1e-3 * s.largest_gram();
      s.solve(damping);
      s.shorten();
      const double hoped = e - s.promised(), after = s.attempt();
      if (after < e) {
        const double ratio = hoped > 0 ? (e - after) / hoped : 1;
        const double f = 2 * std::min(ratio, 1.0) - 1;
        damping *= std::max(1.0 / 3, 1 - f * f * f), growth = 2;
        s.accept();
        e = after, gained = true;
      } else {
        damping *= growth, growth *= 2;
        settled = damping > 1e8 * s.largest_gram();
      }
    }
    rests = !gained ? rests + 1 : before - e < kProgress * before ? rests + 1 : 0;
    if ((gained || !settled) && rests < 25) continue;
    if (nudges++ > 0) {
      out.end = stalled, ++out.iterations, out.error = s.error();
      return out;
    }
    s.nudge();
    e = s.look(), rests = 0, damping = -1;
  }
  out.error = s.error();
  out.end = out.error <= options.tolerance ? reached : exhausted;
  return out;
}

}  // namespace truestep::animation::ik
