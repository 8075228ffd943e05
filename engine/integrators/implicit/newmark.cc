// Newmark's method and the generalized-alpha method for second-order equations, x'' = a(t, x, v):
//   x1 = x + h v + h^2 ((1/2 - beta) a + beta a1),   v1 = v + h ((1 - gamma) a + gamma a1)
//   (1 - am) a1 + am a = a(t + (1 - af) h, (1 - af) x1 + af x, (1 - af) v1 + af v)
// Newmark 1959 with beta = 1/4, gamma = 1/2 is am = af = 0: undamped, unconditionally stable. Chung, Hulbert
// 1993, eq. 13 to 25,
//   am = (2r - 1)/(r + 1),  af = r/(r + 1),  gamma = 1/2 - am + af,  beta = (1 - am + af)^2 / 4,
// damps high frequencies to the spectral radius r at infinity. The scene may choose beta, gamma and r. One
// system of half the size per iteration:
//   ((1 - am) I - (1 - af) gamma h B - (1 - af) beta h^2 A) da1 = -residual,   A = da/dx, B = da/dv.
// Generalized alpha carries its own a, which is not a(t, x, v), in `memory`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/integrators/explicit/drive_fixed.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/newton_iteration.h"
#include "engine/integrators/large_equations.h"

namespace truestep {

namespace {

struct Alpha {
  double m = 0, f = 0, gamma = 0.5, beta = 0.25;
};
Alpha with_radius(double r) {
  const double m = (2 * r - 1) / (r + 1), f = r / (r + 1);
  return {m, f, 0.5 - m + f, 0.25 * (1 - m + f) * (1 - m + f)};
}

enum class Acceleration : uint8_t { evaluated, carried };

constexpr auto alpha_memory_size = generalized_alpha_memory;

class NewmarkSteps final : public Interpolant {
 public:
  NewmarkSteps(LargeEquations& eq, const Alpha& alpha, Acceleration kept)
      : eq_(eq),
        in_(eq.advance()),
        second_(*in_.f.second_order()),
        alpha_(alpha),
        kept_(kept),
        n_(eq.size() / 2) {
    std::copy_n(in_.y, 2 * n_, eq.array(y_));
    second_.reserve_stage();
  }

  // --- drive_fixed.h

  void begin(double t) {
    const double* y = eq_.array(y_);
    double* a = eq_.array(kA);
    if (kept_ == Acceleration::carried && in_.memory.size() == alpha_memory_size(2 * n_) &&
        std::equal(y, y + 2 * n_, in_.memory.data() + n_)) {
      std::copy_n(in_.memory.data(), n_, a);
      return;
    }
    acceleration(t, y, y + n_, a);
  }
  bool step(double t, double h) {
    h_ = h;
    bool fresh = !linearised_;
    for (;; fresh = true) {
      if (!linearised_ || h != factored_) {
        if (!linearised_) {
          // Differences need the rate at exactly this point.
          double* rate = eq_.array(kPoint);
          const double* y = eq_.array(y_);
          std::copy_n(y + n_, n_, rate);
          if (!second_.has_jacobian()) acceleration(t, y, y + n_, rate + n_);
          eq_.differentiate(t, y, rate);
        }
        linearised_ = true, factored_ = 0;
        const double f = (1 - alpha_.f) / (1 - alpha_.m);
        ++eq_.count().factorisations;
        if (!eq_.matrix().factor_second_order(f * alpha_.beta * h * h, f * alpha_.gamma * h)) return false;
        factored_ = h;
      }
      if (iterate(t, h)) return true;
      if (fresh) return own_method(t, h);
      linearised_ = false;
    }
  }
  double* candidate() { return eq_.array(1 - y_); }
  const double* solution() const { return eq_.array(y_); }
  const Interpolant& between(double, double) { return *this; }
  void accept(double) {
    y_ = 1 - y_;
    std::copy_n(eq_.array(kA1), n_, eq_.array(kA));
    if (theta_ > 0.05) linearised_ = false;
  }
  long long worst(double) const { return 0; }

  /// Hermite on x and on v, order 3.
  void at(double s, double* out) const override {
    const double *y0 = eq_.array(y_), *y1 = eq_.array(1 - y_), *a0 = eq_.array(kA), *a1 = eq_.array(kA1);
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < n_; ++i) {
      const size_t k = n_ + i;
      out[i] = y0[i] + (w * (y1[i] - y0[i]) + (w0 * y0[k] + w1 * y1[k]));
      out[k] = y0[k] + (w * (y1[k] - y0[k]) + (w0 * a0[i] + w1 * a1[i]));
    }
  }

  void remember() {
    if (in_.project && !in_.memory.empty()) in_.project(in_.f, in_.y);
    if (kept_ == Acceleration::evaluated || in_.memory.size() != alpha_memory_size(2 * n_)) return;
    std::copy_n(eq_.array(kA1), n_, in_.memory.data());
    std::copy_n(in_.y, 2 * n_, in_.memory.data() + n_);
  }

 private:
  enum : size_t { kA = 2, kA1, kPoint, kResidual };
  static constexpr int kMostIterations = 30;

  void acceleration(double t, const double* x, const double* v, double* a) {
    ++eq_.count().rates;
    second_.acceleration(t, x, v, a);
  }

  bool iterate(double t, double h) {
    const double *y = eq_.array(y_), *a = eq_.array(kA);
    double *y1 = eq_.array(1 - y_), *a1 = eq_.array(kA1), *point = eq_.array(kPoint),
           *d = eq_.array(kResidual);
    const double beta = alpha_.beta, gamma = alpha_.gamma, af = alpha_.f, am = alpha_.m;
    std::copy_n(a, n_, a1);
    Convergence convergence(kMostIterations);
    const double along = h * h * beta, across = h * gamma;
    for (size_t i = 0; i < n_; ++i) {
      y1[i] = y[i] + h * y[n_ + i] + h * h * 0.5 * a[i];
      y1[n_ + i] = y[n_ + i] + h * a[i];
    }
    for (;;) {
#pragma GCC ivdep
      for (size_t i = 0; i < 2 * n_; ++i) point[i] = (1 - af) * y1[i] + af * y[i];
      acceleration(t + (1 - af) * h, point, point + n_, d);
      const double scale = 1 / (1 - am);
#pragma GCC ivdep
      for (size_t i = 0; i < n_; ++i) d[i] = scale * (d[i] - am * a[i]) - a1[i];
      ++eq_.count().solves;
      eq_.matrix().solve_second_order(d);
      double moved = 0, size = 0;
      for (size_t i = 0; i < n_; ++i) {
        a1[i] += d[i];
        y1[i] += along * d[i], y1[n_ + i] += across * d[i];
        moved = larger(moved, larger(std::abs(along * d[i]), std::abs(across * d[i])));
        size = larger(size, larger(std::abs(y1[i]), std::abs(y1[n_ + i])));
      }
      const auto verdict = convergence.judge(relative_increment(moved, size, in_.newton_tolerance));
      if (verdict == Convergence::Verdict::failed) return false;
      if (verdict == Convergence::Verdict::done) break;
    }
    theta_ = convergence.theta();
    return true;
  }
  // In V = (1 - af) v1 + af v and X alike, with the acceleration A at (X, V),
  //   V = V0 + g A,  X = X0 + s (V - V0),  g = (1 - af) gamma h / (1 - am),  s = beta h / gamma.
  bool own_method(double t, double h) {
    const double beta = alpha_.beta, gamma = alpha_.gamma, af = alpha_.f, am = alpha_.m;
    const double rest = am / (1 - am), g = (1 - af) * gamma * h / (1 - am), s = beta * h / gamma;
    if (!(s > 0)) return false;
    const double *y = eq_.array(y_), *v = y + n_, *a = eq_.array(kA);
    double *x0 = eq_.array(kPoint), *v0 = x0 + n_, *u = eq_.array(kResidual);
    for (size_t i = 0; i < n_; ++i) {
      v0[i] = v[i] + (1 - af) * h * (1 - gamma - gamma * rest) * a[i];
      x0[i] = y[i] + (1 - af) * h * (v[i] + h * (0.5 - beta - beta * rest) * a[i]) - s * v0[i];
    }
    if (!second_.solve_stage({t + (1 - af) * h, g, s, x0, v0, in_.newton_tolerance}, u)) return false;
    double *y1 = eq_.array(1 - y_), *a1 = eq_.array(kA1);
    for (size_t i = 0; i < n_; ++i) {
      a1[i] = (u[i] - v0[i]) / (g * (1 - am)) - rest * a[i];
      y1[i] = y[i] + h * v[i] + h * h * ((0.5 - beta) * a[i] + beta * a1[i]);
      y1[n_ + i] = v[i] + h * ((1 - gamma) * a[i] + gamma * a1[i]);
    }
    theta_ = 1;
    return true;
  }
  // The larger one, or NaN if either is.
  static double larger(double a, double b) {
    return b <= a ? a : a != a ? a : b;
  }

  LargeEquations& eq_;
  Advance& in_;
  const SecondOrder& second_;
  Alpha alpha_;
  Acceleration kept_;
  size_t n_, y_ = 0;
  bool linearised_ = false;
  double factored_ = 0, h_ = 0, theta_ = 0;
};

void advance(Advance& a, const Alpha& alpha, Acceleration kept) {
  if (!a.f.second_order()) {
    throw Error("not_second_order", "this method needs equations of second order, x'' = a(t, x, v)");
  }
  if (a.f.size() == 0) {
    a.reached = a.t_end;
    return;
  }
  LargeEquations eq(a);
  NewmarkSteps method(eq, alpha, kept);
  drive_fixed(a, method);
  method.remember();
}

}  // namespace

// Layout: a, then the y that belongs to it.
size_t generalized_alpha_memory(size_t n) {
  return n / 2 + n;
}

void prepare_generalized_alpha(const ForceField& field, State& state) {
  add_memory(state, alpha_memory_size(2 * state.f64(state.at("velocity")).size()));
}

// Without damping the map of one step has eigenvalues on the unit circle up to omega h = 1 / sqrt(gamma/2 -
// beta) if 2 beta < gamma, always otherwise (Hughes 1987, section 9.1); damping alone is always stable for
// gamma >= 1/2, and both together are stable whenever the undamped motion is. Generalized alpha is
// unconditionally stable for every r in [0, 1].
StabilityInterval newmark_interval(const IntegratorOptions& options) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  const double short_of = 0.5 * options.damping.newmark_gamma - options.damping.newmark_beta;
  return {short_of > 0 ? 1 / std::sqrt(short_of) : kUnlimited, kUnlimited};
}

std::optional<std::string> refuses_first_order(const ForceField& field) {
  if (auto why = refuses_without_jacobian(field)) return why;
  return refuses_general_rates(field);
}

void advance_newmark(Advance& a) {
  advance(a, {.gamma = a.damping.newmark_gamma, .beta = a.damping.newmark_beta}, Acceleration::evaluated);
}
void advance_generalized_alpha(Advance& a) {
  advance(a, with_radius(a.damping.spectral_radius), Acceleration::carried);
}

}  // namespace truestep
