// Radau IIA of order 5: three implicit stages at c = (4 - sqrt 6)/10, (4 + sqrt 6)/10, 1, coupled through A.
// With T^-1 A^-1 T = diag(g, (a -b; b a)) the 3n equations Z = h (A x I) F(y + Z) become a real system and a
// complex one of size n:
//   (g/h I - J) w1 = ...,   ((a + i b)/h I - J) (w2 + i w3) = ...
// solved by simplified Newton iterations with the contraction test, the initial guess from the last step's
// collocation polynomial, the filtered error estimate of order 3 and the predictive step control of Hairer,
// Wanner 1996, section IV.8. Jacobian and factors are kept while iterations contract fast, within one call
// only.
#include <array>

#include "engine/integrators/explicit/drive.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/newton_iteration.h"
#include "engine/integrators/implicit/radau5_coefficients.h"
#include "engine/integrators/small_equations.h"

namespace truestep {

namespace {

using namespace radau5;

template <class Equations>
class Radau5 final : public Interpolant {
 public:
  explicit Radau5(Equations& eq) : eq_(eq), a_(eq.advance()), scale_(eq, Scale::By::tolerance) {
    std::copy_n(a_.y, eq.size(), eq.array(kY));
  }

  void run() {
    using step_control::rough_pow;
    t_ = a_.t;
    eq_.rate(t_, eq_.array(kY), eq_.array(kRate));
    h_ = a_.carry.step > 0 ? a_.carry.step : first_step();
    uint64_t steps = 0, rejected = 0;
    double h_accepted = 0, error_accepted = 0;
    bool retry = true;  // the first step, and those after a rejection, check their error twice
    for (;;) {
      const double left = a_.t_end - t_;
      const bool last = h_ >= left * (1 - 1e-12);
      // Less than two steps left: two equal ones, so that no sliver remains.
      const double h = last ? left : 2 * h_ > left ? 0.5 * left : h_;
      if (steps + rejected >= a_.max_steps) step_control::too_many_steps(a_, t_, h);
      const double shrink = iterate(h);
      if (shrink < 1) {
        h_ = reject(h, shrink, rejected);
        retry = true;
        continue;
      }
      const double error = estimate(h, retry);
      // Many iterations mean less trust: 1 for a system solved at once.
      const double safety = 0.9 * (1 + 2 * kMost) / (iterations_ + 2 * kMost);
      if (!(error < 1)) {
        const double factor =
            std::isfinite(error) ? std::clamp(safety * rough_pow(error, -0.25), 0.1, 0.9) : 0.1;
        h_ = reject(h, steps == 0 ? std::min(factor, 0.1) : factor, rejected);
        retry = true;
        continue;
      }
      ++steps;
      double factor = safety * rough_pow(error, -0.25);
      if (h_accepted > 0) {
        factor = std::min(factor, 0.9 * (h / h_accepted) * rough_pow(error_accepted / (error * error), 0.25));
      }
      factor = std::clamp(factor, 0.2, retry && steps > 1 ? 1.0 : 8.0);
      retry = false;
      h_accepted = h, error_accepted = std::max(error, 0.01);
      a_.carry.last_error = error;
      if (finish(h, last)) break;
      // A step cut short by the end does not count against the longer one; a step that would grow by less
      // than a fifth is kept, together with its factors.
      double next = h < h_ ? std::max(h_, h * factor) : h * factor;
      if (slow_contraction()) {
        linearised_ = false;
      } else if (next >= h && next <= 1.2 * h && factored_ == h) {
        next = h;
      }
      h_ = next;
    }
    a_.carry.step = h_;
    if (a_.statistics) a_.statistics->steps += steps, a_.statistics->rejected += rejected;
  }

  // --- Interpolant: the collocation polynomial, order 3

  void at(double theta, double* y) const override {
    const double s = theta - 1;
    for (size_t i = 0; i < eq_.size(); ++i) y[i] = eq_.array(kNew)[i] + polynomial(s, i);
  }

 private:
  using Scale = IncrementScale<Equations>;
  // Q: the collocation polynomial's coefficients, Z: stages minus y, W: the same transformed.
  enum : size_t { kY, kNew, kRate, kZ, kW = kZ + 3, kD = kW + 3, kQ = kD + 3, kArgument = kQ + 3, kError };
  static constexpr int kMost = 7;  // iterations that the step control considers many

  double first_step() {
    ++eq_.count().rates;
    return step_control::first_step(a_, eq_.array(kY), eq_.array(kRate), 3, eq_.array(kArgument),
                                    eq_.array(kError));
  }

  // y(t1 + s h) - y1 for component i.
  double polynomial(double s, size_t i) const {
    const double *q1 = eq_.array(kQ), *q2 = eq_.array(kQ + 1), *q3 = eq_.array(kQ + 2);
    return s * (q1[i] + (s + 1 - kC2) * (q2[i] + (s + 1 - kC1) * q3[i]));
  }

  double reject(double h, double factor, uint64_t& rejected) {
    ++rejected;
    const double shorter = h * factor;
    if (shorter <= step_control::smallest_step(a_, t_)) {
      step_control::give_up(a_, t_, shorter, eq_.array(kY), eq_.array(kNew), worst());
    }
    have_polynomial_ = false;
    return shorter;
  }

  // Solves for the stages; returns 1, or the factor by which the step should shrink.
  double iterate(double h) {
    for (;;) {
      const bool fresh = !linearised_ || fresh_;
      if (!linearised_) {
        eq_.differentiate(t_, eq_.array(kY), eq_.array(kRate));
        linearised_ = fresh_ = true, factored_ = 0;
      }
      if (factored_ != h) {
        factored_ = 0;
        if (!eq_.factor(h * kInverseGamma) || !eq_.factor(Complex{kInverse.re * h, kInverse.im * h})) {
          return 0.5;
        }
        factored_ = h;
      }
      const double shrink = newton(h);
      if (shrink == 1 || fresh) return shrink;
      // The Jacobian was old: the same step with a new one.
      linearised_ = false;
    }
  }

  void predict(double h) {
    const size_t n = eq_.padded();
    double* z[3] = {eq_.array(kZ), eq_.array(kZ + 1), eq_.array(kZ + 2)};
    if (!have_polynomial_) {
      for (size_t k = 0; k < 6; ++k) std::fill_n(eq_.array(kZ + k), n, 0.0);
      return;
    }
    // The polynomial is relative to its own end, the present y.
    const double ratio = h / h_polynomial_;
    for (size_t i = 0; i < n; ++i) {
      z[0][i] = polynomial(kC1 * ratio, i);
      z[1][i] = polynomial(kC2 * ratio, i);
      z[2][i] = polynomial(ratio, i);
    }
    transform(kInverseT, kZ, kW);
  }

  // to_r = sum_c m[r][c] from_c
  void transform(const Matrix& m, size_t from, size_t to) {
    const double *a = eq_.array(from), *b = eq_.array(from + 1), *c = eq_.array(from + 2);
    double *x = eq_.array(to), *y = eq_.array(to + 1), *z = eq_.array(to + 2);
    const size_t n = eq_.padded();
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) {
      const double p = a[i], q = b[i], r = c[i];
      x[i] = m[0][0] * p + m[0][1] * q + m[0][2] * r;
      y[i] = m[1][0] * p + m[1][1] * q + m[1][2] * r;
      z[i] = m[2][0] * p + m[2][1] * q + m[2][2] * r;
    }
  }

  double newton(double h) {
    constexpr double kNodes[3] = {kC1, kC2, 1};
    const size_t n = eq_.padded();
    const double* y = eq_.array(kY);
    const double* z3 = eq_.array(kZ + 2);
    double* argument = eq_.array(kArgument);
    double* y_new = eq_.array(kNew);
    predict(h);
    Convergence convergence(scale_.most_iterations(),
                            std::max(quality_ > 0 ? rough_quality() : 1.0, 0x1p-40));
    for (;;) {
      for (size_t k = 0; k < 3; ++k) {
        const double* z = eq_.array(kZ + k);
        for (size_t i = 0; i < n; ++i) argument[i] = y[i] + z[i];
        eq_.rate(t_ + kNodes[k] * h, argument, eq_.array(kD + k));
      }
      transform(kInverseT, kD, kD);
      // Right-hand sides times h/g and h/(a + ib): (I - z J) d = z F - w.
      double *d1 = eq_.array(kD), *d2 = eq_.array(kD + 1), *d3 = eq_.array(kD + 2);
      const double *w1 = eq_.array(kW), *w2 = eq_.array(kW + 1), *w3 = eq_.array(kW + 2);
      const double z1 = h * kInverseGamma;
      const Complex z2{kInverse.re * h, kInverse.im * h};
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) {
        d1[i] = z1 * d1[i] - w1[i];
        const double p = d2[i], q = d3[i];
        d2[i] = (z2.re * p - z2.im * q) - w2[i];
        d3[i] = (z2.re * q + z2.im * p) - w3[i];
      }
      eq_.solve(d1);
      eq_.solve(d2, d3);
      for (size_t k = 0; k < 3; ++k) {
        double* w = eq_.array(kW + k);
        const double* d = eq_.array(kD + k);
        for (size_t i = 0; i < n; ++i) w[i] += d[i];
      }
      transform(kT, kW, kZ);
      for (size_t i = 0; i < n; ++i) y_new[i] = y[i] + z3[i];
      const auto verdict = convergence.judge(root_mean_square(d1, d2, d3));
      if (verdict == Convergence::Verdict::failed) {
        quality_ = 0;
        return 0.5;
      }
      if (verdict == Convergence::Verdict::done) break;
    }
    iterations_ = convergence.iterations();
    theta_ = convergence.theta();
    quality_ = convergence.quality();
    return 1;
  }
  double rough_quality() const {
    return step_control::rough_pow(quality_, 0.8);
  }

  double root_mean_square(const double* d1, const double* d2, const double* d3) const {
    const double* y = eq_.array(kNew);
    const double a = scale_(d1, y), b = scale_(d2, y), c = scale_(d3, y);
    return std::sqrt((a * a + b * b + c * c) / 3);
  }

  // (I - z1 J)^-1 (z1 f(y) + sum_k e_k Z_k), twice when stiff components may inflate it.
  double estimate(double h, bool again) {
    const size_t n = eq_.padded();
    double* e = eq_.array(kError);
    double* part = eq_.array(kD);
    const double *z1 = eq_.array(kZ), *z2 = eq_.array(kZ + 1), *z3 = eq_.array(kZ + 2);
    const double *rate = eq_.array(kRate), *y = eq_.array(kY), *y_new = eq_.array(kNew);
    const double z = h * kInverseGamma;
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) {
      part[i] = kInverseGamma * (kE1 * z1[i] + kE2 * z2[i] + kE3 * z3[i]);
      e[i] = z * rate[i] + part[i];
    }
    eq_.solve(e);
    double error = eq_.norm(e, y, y);
    if (again && !(error < 1)) {
      double* argument = eq_.array(kArgument);
      for (size_t i = 0; i < n; ++i) argument[i] = y[i] + e[i];
      eq_.rate(t_, argument, e);
      for (size_t i = 0; i < n; ++i) e[i] = z * e[i] + part[i];
      eq_.solve(e);
      error = eq_.norm(e, y, y);
    }
    for (size_t i = 0; i < eq_.size(); ++i) {
      if (!std::isfinite(y_new[i])) return HUGE_VAL;
    }
    return error > 1e-10 || std::isnan(error) ? error : 1e-10;
  }

  // With slower contraction than this, a new Jacobian costs less than the iterations it saves.
  bool slow_contraction() const {
    return iterations_ > 1 && theta_ > 1e-3;
  }

  // Accepts the step; true: the run ends here.
  bool finish(double h, bool last) {
    const size_t n = eq_.padded();
    double *q1 = eq_.array(kQ), *q2 = eq_.array(kQ + 1), *q3 = eq_.array(kQ + 2);
    const double *z1 = eq_.array(kZ), *z2 = eq_.array(kZ + 1), *z3 = eq_.array(kZ + 2);
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) {
      const double first = (z1[i] - z2[i]) * (1 / (kC1 - kC2)), from_start = z1[i] * (1 / kC1);
      q1[i] = (z2[i] - z3[i]) * (1 / (kC2 - 1));
      q2[i] = (first - q1[i]) * (1 / (kC1 - 1));
      q3[i] = q2[i] - (first - from_start) * (1 / kC2);
    }
    have_polynomial_ = true, h_polynomial_ = h;
    double t1 = last ? a_.t_end : t_ + h;
    auto verdict = StepWatcher::Verdict::go_on;
    if (a_.watcher) verdict = a_.watcher->accepted(t_, t1, eq_.array(kNew), *this);
    std::copy_n(eq_.array(kNew), n, eq_.array(kY));
    t_ = t1;
    fresh_ = false;
    if (last || verdict == StepWatcher::Verdict::stop) {
      std::copy_n(eq_.array(kNew), eq_.size(), a_.y);
      a_.reached = t1;
      return true;
    }
    eq_.rate(t_, eq_.array(kY), eq_.array(kRate));
    return false;
  }

  long long worst() const {
    size_t most = 0;
    double largest = -1;
    for (size_t i = 0; i < eq_.size(); ++i) {
      const double q =
          std::abs(eq_.array(kError)[i]) / step_control::weight(a_.tolerance, i, eq_.array(kY)[i]);
      if (q > largest) largest = q, most = i;
    }
    return static_cast<long long>(most);
  }

  Equations& eq_;
  Advance& a_;
  Scale scale_;
  double t_ = 0, h_ = 0, h_polynomial_ = 0, factored_ = 0, theta_ = 0, quality_ = 0;
  int iterations_ = 0;
  bool linearised_ = false, fresh_ = false, have_polynomial_ = false;
};

}  // namespace

// Known sizes take 17 to 30 % less time than any size; of 8 equations 7 % more
// (tests/bench/work_precision.py).
void advance_radau5(Advance& a) {
  visit_equations<1, 2, 3, 4>(a, [](auto& eq) { Radau5<std::remove_reference_t<decltype(eq)>>(eq).run(); });
}

}  // namespace truestep
