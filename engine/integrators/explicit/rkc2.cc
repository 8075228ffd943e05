// rkc2, the Runge-Kutta-Chebyshev method of order 2 of Sommeijer, Shampine, Verwer 1998, "RKC: an explicit
// solver for parabolic PDEs", J. Comput. Appl. Math. 88, eqs. 2.1 to 2.8: s stages make its stability
// interval 0.653 (s + 1)^2 long on the negative real axis, so that a step of any length costs a number of
// evaluations that grows with its square root only. With T_j Chebyshev's polynomials, w0 = 1 + 2/(13 s^2),
// w1 = T_s'(w0) / T_s''(w0), b_j = T_j'' / T_j'^2, a_j = 1 - b_j T_j (all at w0; b_0 = b_1 = b_2):
//   Y_0 = y,  Y_1 = y + b_1 w1 h F_0
//   Y_j = (1 - mu - nu) y + mu Y_{j-1} + nu Y_{j-2} + mu~ h (F_{j-1} - a_{j-1} F_0),
//   mu = 2 b_j w0 / b_{j-1},  nu = -b_j / b_{j-2},  mu~ = 2 b_j w1 / b_{j-1}
// The error estimate is 4/5 (y - y') + 2/5 h (F + F'), eq. 2.9. The spectral radius is the right-hand side's
// own bound, or a nonlinear power iteration's (section 3) plus a fifth, renewed after 25 steps and after a
// rejected one. Not for undamped oscillations: the stability region contains none of the imaginary axis.
#include <cmath>

#include "engine/integrators/explicit/arrays.h"
#include "engine/integrators/explicit/drive.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

/// T_j, T_j', T_j'' at w0, j counting up.
struct Chebyshev {
  explicit Chebyshev(double w) : w0(w), t{w, 1}, d{1, 0}, dd{0, 0} {}
  void next() {
    const double t2 = 2 * w0 * t[0] - t[1], d2 = 2 * w0 * d[0] - d[1] + 2 * t[0];
    const double dd2 = 2 * w0 * dd[0] - dd[1] + 4 * d[0];
    t = {t2, t[0]}, d = {d2, d[0]}, dd = {dd2, dd[0]};
  }
  double w0;
  std::array<double, 2> t, d, dd;  ///< at j and at j - 1
};

class Rkc2 final : public AdaptiveMethod {
 public:
  explicit Rkc2(Advance& in) : in_(in), n_(in.f.size()), a_(in, "integrator.rkc2", n_) {
    std::copy_n(in.y, n_, a_[kY]);
    // More stages would let their rounding errors exceed the tolerance (RKC's own bound).
    const double tolerance = std::max(in.tolerance.relative, in.tolerance.absolute);
    most_stages_ = std::clamp(std::sqrt(tolerance / (10 * 0x1p-52)), 50.0, 1e5);
  }
  ~Rkc2() override {
    if (in_.statistics) in_.statistics->rates += rates_;
  }

  // --- drive.h

  void begin(double t) override { rate(t, a_[kY], a_[kFirst]); }
  double first_step() override {
    ++rates_;
    return step_control::first_step(in_, a_[kY], a_[kFirst], 2, a_[kNew], a_[kBefore]);
  }
  double attempt(double t, double h) override {
    constexpr int kStepsPerEstimate = 25;
    if (!fresh_ && (rejected_ || steps_ >= kStepsPerEstimate || !known_)) estimate(t);
    const double wanted = 1 + std::sqrt(1.54 * h * radius_ + 1);
    if (wanted > most_stages_) {
      // The longest step for the largest number of stages, as if the error had required it.
      const double ratio = 1.2 * (wanted * wanted) / (most_stages_ * most_stages_);
      return ratio * ratio * ratio * ratio * ratio * ratio;
    }
    step(t, h, radius_ < HUGE_VAL ? std::max(2, static_cast<int>(wanted)) : 2);
    rate(t + h, a_[kNew], a_[kLast]);
    const double *y = a_[kY], *z = a_[kNew];
    const double relative = in_.tolerance.relative, absolute = in_.tolerance.absolute;
    const auto term = [&](size_t i, double abs) {
      const double p = std::abs(y[i]), r = std::abs(z[i]), size = p > r ? p : r;
      const double q = error(i, h) / std::fma(relative, size, abs);
      return q * q;
    };
    double sum = 0;
    if (in_.tolerance.absolute_each.empty()) {
      sum = a_.sum([&](size_t i) { return term(i, absolute); });
    } else {
      const double* each = in_.tolerance.absolute_each.data();
      sum = a_.sum([&](size_t i) { return term(i, each[i]); });
    }
    const double squared = sum / static_cast<double>(n_);
    rejected_ = !(squared <= 1);
    return squared;
  }
  double* candidate() override { return a_[kNew]; }
  const double* solution() const override { return a_[kY]; }
  const Interpolant& between(double, double h) override {
    h_ = h;
    return *this;
  }
  void accept(double) override {
    a_.take(kY, kNew);
    a_.take(kFirst, kLast);
    ++steps_, fresh_ = false;
  }
  long long worst(double h) const override {
    return step_control::worst_component(in_, n_, a_[kY], [&](size_t i) { return error(i, h); });
  }

  // --- Interpolant: Hermite, order 3

  void at(double s, double* out) const override {
    const double *y0 = a_[kY], *y1 = a_[kNew], *k0 = a_[kFirst], *k1 = a_[kLast];
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < n_; ++i) out[i] = y0[i] + (w * (y1[i] - y0[i]) + (w0 * k0[i] + w1 * k1[i]));
  }

 private:
  enum : size_t { kY, kNew, kFirst, kLast, kBefore, kBefore2, kDirection, kCount };

  void rate(double t, const double* y, double* k) {
    in_.f.rate(t, y, k);
    ++rates_;
  }
  double error(size_t i, double h) const {
    return 0.8 * (a_[kY][i] - a_[kNew][i]) + 0.4 * h * (a_[kFirst][i] + a_[kLast][i]);
  }

  void step(double t, double h, int stages) {
    const double s2 = static_cast<double>(stages) * static_cast<double>(stages), w0 = 1 + 2 / (13 * s2);
    Chebyshev last(w0);
    for (int j = 2; j <= stages; ++j) last.next();
    const double w1 = last.d[0] / last.dd[0];
    const double *y = a_[kY], *first = a_[kFirst];
    double b1 = 1 / (4 * w0 * w0), b2 = b1;  // b_{j-1}, b_{j-2}
    double c1 = w1 * b1, c2 = 0;             // positions of the stages in the step
    {
      double *one = a_[kBefore], *none = a_[kBefore2];
      const double z = h * w1 * b1;
      a_.loop([=](size_t i) { one[i] = std::fma(z, first[i], y[i]), none[i] = y[i]; });
    }
    Chebyshev p(w0);
    for (int j = 2; j <= stages; ++j) {
      const double a = 1 - p.t[0] * b1;
      p.next();
      const double b = p.dd[0] / (p.d[0] * p.d[0]);
      const double mu = 2 * w0 * b / b1, nu = -b / b2, tilde = mu * w1 / w0, rest = 1 - mu - nu;
      double* k = a_[kLast];
      rate(t + c1 * h, a_[kBefore], k);
      const double *before = a_[kBefore], *before2 = a_[kBefore2];
      double* out = a_[kNew];
      const double with = h * tilde, without = -h * tilde * a;
      a_.loop([=](size_t i) {
        out[i] = rest * y[i] + mu * before[i] + nu * before2[i] + with * k[i] + without * first[i];
      });
      const double c = mu * c1 + nu * c2 + tilde * (1 - a);
      c2 = c1, c1 = c, b2 = b1, b1 = b;
      if (j == stages) break;
      a_.exchange(kBefore2, kBefore);
      a_.exchange(kBefore, kNew);
    }
  }

  double size_of(const double* v) const {
    return std::sqrt(a_.sum([=](size_t i) { return v[i] * v[i]; }));
  }

  /// The spectral radius at (t, y); a_[kFirst] is f there.
  void estimate(double t) {
    fresh_ = known_ = true;
    steps_ = 0;
    if (const auto known = in_.f.spectral_radius(t, a_[kY])) {
      radius_ = *known;
      return;
    }
    constexpr int kMostIterations = 50;
    constexpr double kRoot = 0x1p-26;
    const double *y = a_[kY], *f = a_[kFirst];
    double *v = a_[kDirection], *z = a_[kBefore], *k = a_[kBefore2];
    if (!direction_) {
      for (size_t i = 0; i < n_; ++i) v[i] = f[i];
      direction_ = true;
    }
    double length = size_of(v);
    if (!(length > 0)) {
      // A vector with a component along everything, the same everywhere.
      for (size_t i = 0; i < n_; ++i) v[i] = 1 + 0.1 * static_cast<double>((i * 2654435761u) % 17);
      length = size_of(v);
    }
    const double size = size_of(y), distance = size > 0 ? size * kRoot : kRoot;
    double sigma = 0;
    for (int m = 0; m < kMostIterations; ++m) {
      const double scale = distance / length;
      a_.loop([=](size_t i) { z[i] = std::fma(scale, v[i], y[i]); });
      rate(t, z, k);
      a_.loop([=](size_t i) { v[i] = k[i] - f[i]; });
      length = size_of(v);
      const double before = sigma;
      sigma = length / distance;
      if (!(sigma > 0) || !(sigma < HUGE_VAL)) break;
      if (m > 0 && std::abs(sigma - before) <= 0.01 * sigma) break;
    }
    radius_ = 1.2 * sigma;
    if (!(length > 0)) direction_ = false;
  }

  Advance& in_;
  size_t n_;
  Arrays<0, kCount> a_;
  uint64_t rates_ = 0;
  double radius_ = 0, h_ = 0, most_stages_ = 0;
  int steps_ = 0;
  bool known_ = false, fresh_ = false, rejected_ = false, direction_ = false;
};

}  // namespace

void advance_rkc2(Advance& in) {
  Rkc2 method(in);
  drive<AdaptiveMethod>(in, method, {.q = 3, .safety = 0.8});
}

}  // namespace truestep
