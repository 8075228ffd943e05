// When Newton's method has converged: simplified iterations contract by a factor theta, so the error after an
// increment d is about theta / (1 - theta) |d| (Hairer, Wanner 1996, eq. IV.8.10). Increments are measured
// against the error tolerance of an adaptive method, 1 = kappa tolerances. Fixed-step methods, and adaptive
// ones whose tolerance exceeds the solution itself (it is then meaningless), measure against a hundredth of
// newton_tolerance times the largest component.
#pragma once
#include <cmath>

#include "engine/integrators/equations.h"

namespace truestep {

/// Size of the largest increment `moved` of values up to `size` for a method without error control; 1 is
/// small enough: a hundredth of newton_tolerance, because the remaining errors add up from step to step.
/// Increments of a few roundings, and those of negligible values, count as 0.
inline double relative_increment(double moved, double size, double newton_tolerance) {
  constexpr double kRoundings = 8 * 0x1p-52, kNothing = 1e-280;
  if (moved <= kRoundings * size || moved <= kNothing) return 0;
  return moved / (0.01 * newton_tolerance * size);
}

/// How an integration measures Newton's increments.
template <class Equations>
class IncrementScale {
 public:
  enum class By : uint8_t { tolerance, solution };
  IncrementScale(const Equations& eq, By by) : eq_(eq), by_(by) {
    const Tolerance& t = eq.advance().tolerance;
    if (by == By::tolerance && t.absolute_each.empty() && t.absolute > 1e3 * largest(eq.advance().y)) {
      by_ = By::solution;
    }
    // Tighter than the tolerance by a factor that keeps the iteration's error out of the error estimate.
    if (t.relative > 0) {
      kappa_ = std::max(10 * 0x1p-52 / t.relative, std::min(0.03, std::sqrt(t.relative)));
    }
  }

  /// Size of increment d of a solution near y; 1 is small enough.
  double operator()(const double* d, const double* y) const {
    if (by_ == By::tolerance) return eq_.norm(d, y, y) / kappa_;
    return relative_increment(largest(d), largest(y), eq_.advance().newton_tolerance);
  }
  /// Iterations after which a shorter step or a new Jacobian is better; a fixed step has no alternative.
  int most_iterations() const { return by_ == By::tolerance ? 10 : 30; }
  /// Whether the method may take a shorter step instead.
  bool shortens_steps() const { return by_ == By::tolerance; }

 private:
  // Largest absolute value, NaN if there is one.
  double largest(const double* y) const {
    double m = 0;
    for (size_t i = 0; i < eq_.size(); ++i) {
      const double a = std::abs(y[i]);
      if (!(a <= m) && m == m) m = a;
    }
    return m;
  }
  const Equations& eq_;
  By by_;
  double kappa_ = 0.03;
};

/// Progress of one iteration, fed with the size of every increment.
class Convergence {
 public:
  enum class Verdict : uint8_t { go_on, done, failed };
  /// `quality` is theta / (1 - theta) left by an earlier system with a similar matrix.
  explicit Convergence(int most, double quality = 1) : most_(most), quality_(quality) {}

  Verdict judge(double size) {
    ++iterations_;
    if (!std::isfinite(size)) return Verdict::failed;
    if (iterations_ > 1) {
      const double ratio = size / last_;
      theta_ = iterations_ == 2 ? ratio : std::sqrt(ratio * last_ratio_);
      last_ratio_ = ratio;
      if (size > 0 && theta_ >= 0.99) return Verdict::failed;
      quality_ = theta_ / (1 - theta_);
    }
    if (quality_ * size <= 1) return Verdict::done;
    if (iterations_ >= most_) return Verdict::failed;
    if (iterations_ > 1) {
      // Hopeless at this rate?
      double then = quality_ * size;
      for (int k = iterations_; k < most_ && then > 1; ++k) then *= theta_;
      if (then > 1) return Verdict::failed;
    }
    last_ = size;
    return Verdict::go_on;
  }
  int iterations() const { return iterations_; }
  double theta() const { return theta_; }
  double quality() const { return quality_; }

 private:
  int most_, iterations_ = 0;
  double quality_, last_ = 0, last_ratio_ = 0, theta_ = 0;
};

}  // namespace truestep
