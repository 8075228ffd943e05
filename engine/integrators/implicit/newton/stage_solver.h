// Solves the stage equations of most implicit methods,
//   Y = base + z f(t, Y),
// by simplified Newton iterations with (I - z J)^-1. The Jacobian is that of a step's start or an earlier
// one; it is recomputed when iterations contract slowly or fail. The factors are kept as long as z and J are.
// If a fixed step still fails, the full Newton method follows: a Jacobian at every iterate, and increments
// shortened until the next one promises to be smaller (natural monotonicity, Deuflhard 2004, section 3.3),
// and then the equations' own method, if they have one.
#pragma once
#include "engine/integrators/implicit/newton/newton_iteration.h"

namespace truestep {

template <class Equations>
class StageSolver {
 public:
  using Scale = IncrementScale<Equations>;
  StageSolver(Equations& eq, typename Scale::By by) : eq_(eq), scale_(eq, by) {
    if (second_order() && !scale_.shortens_steps()) second_order()->reserve_stage();
  }

  /// Before a step from (t, y) with rate f(t, y); false: no factors. May be repeated with another z.
  bool prepare(double t, const double* y, const double* rate, double z) {
    if (!linearised_) {
      eq_.differentiate(t, y, rate);
      linearised_ = fresh_ = true;
      factored_ = 0;
    }
    if (factored_ == z) return true;
    factored_ = 0;
    if (!eq_.factor(z)) return false;
    factored_ = z;
    return true;
  }
  /// y: a guess, then the solution; d: scratch. False: no convergence.
  bool solve(double t, const double* base, double z, double* y, double* d) {
    if (whole_) return newton(t, base, z, y, d) || own_method(t, base, z, y);
    const size_t n = eq_.padded();
    Convergence convergence(scale_.most_iterations());
    for (;;) {
      eq_.rate(t, y, d);
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) d[i] = (base[i] - y[i]) + z * d[i];
      eq_.solve(d);
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) y[i] += d[i];
      const auto verdict = convergence.judge(scale_(d, y));
      if (verdict == Convergence::Verdict::failed) return false;
      if (verdict == Convergence::Verdict::done) break;
    }
    slowest_ = std::max(slowest_, convergence.theta());
    return true;
  }
  /// After a failure: true when the same step deserves another try, with a new Jacobian or more.
  bool try_again() {
    if (fresh_ && (whole_ || scale_.shortens_steps())) return false;
    whole_ = fresh_;
    linearised_ = false;
    return true;
  }
  /// After an accepted step: the Jacobian is now old, and bad if iterations were slow.
  void step_accepted() {
    fresh_ = false;
    if (slowest_ > kSlow || whole_) linearised_ = false;
    slowest_ = 0;
    whole_ = false;
  }

 private:
  static constexpr double kSlow = 0.05, kShortest = 1e-3;
  static constexpr int kMostIterations = 50;
  enum : size_t { kTrial = kWorkArrays - 2, kNext };

  bool newton(double t, const double* base, double z, double* y, double* d) {
    const size_t n = eq_.padded();
    double *trial = eq_.array(kTrial), *next = eq_.array(kNext);
    const auto increment = [&](const double* at, double* rate) {
      for (size_t i = 0; i < n; ++i) rate[i] = (base[i] - at[i]) + z * rate[i];
      eq_.solve(rate);
    };
    for (int k = 0; k < kMostIterations; ++k) {
      eq_.rate(t, y, d);
      eq_.differentiate(t, y, d);
      factored_ = 0;
      if (!eq_.factor(z)) return false;
      factored_ = z;
      increment(y, d);
      const double size = scale_(d, y);
      for (double share = 1;; share *= 0.5) {
        if (!(share > kShortest)) return false;
        for (size_t i = 0; i < n; ++i) trial[i] = y[i] + share * d[i];
        if (size <= 1) break;
        eq_.rate(t, trial, next);
        increment(trial, next);
        if (scale_(next, y) <= (1 - 0.25 * share) * size) break;
      }
      std::copy_n(trial, n, y);
      if (size <= 1) return true;
    }
    return false;
  }

  const SecondOrder* second_order() const {
    return eq_.f().second_order();
  }

  // With y = (x, u) the stage is u = base_u + z a(t, x, u), x = base_x + z u.
  bool own_method(double t, const double* base, double z, double* y) {
    if (!second_order()) return false;
    const size_t n = eq_.size() / 2;
    const double tolerance = eq_.advance().newton_tolerance;
    if (!second_order()->solve_stage({t, z, z, base, base + n, tolerance}, y + n)) return false;
    for (size_t i = 0; i < n; ++i) y[i] = base[i] + z * y[n + i];
    return true;
  }

  Equations& eq_;
  Scale scale_;
  bool linearised_ = false, fresh_ = false, whole_ = false;
  double factored_ = 0, slowest_ = 0;
};

}  // namespace truestep
