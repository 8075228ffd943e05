// ias15: Gauss-Radau collocation of order 15 on x'' = a(t, x, v), solved by prediction and correction.
//   a(t0 + s h) = a_0 + b_0 s + b_1 s^2 + ... + b_6 s^7,   sampled at the Radau points s_1 ... s_7,
//   v = v_0 + h s (a_0 + s (b_0/2 + s (b_1/3 + ...))),
//   x = x_0 + h s v_0 + h^2 s^2 (a_0/2 + s (b_0/6 + ...)).
// Everhart 1985, "An efficient integrator that uses Gauss-Radau spacings"; step control, convergence and
// compensated sums as in Rein, Spiegel 2015, "IAS15: a fast, adaptive, high-order integrator", eqs. 8 to 11.
// Differences: each coefficient is found by divided differences of the samples over s (the g of the papers);
// the step's bound on |b_6| / |a_0| is epsilon = max(1e-9, 0.1 tolerance^(7/16)), because |b_6| falls like
// h^7 and the local error like h^16; a step has converged when no coefficient changes any more, not b_6
// alone, which in short steps is below rounding before the others are found. The remainders of the sums and
// the polynomials that predict the next step are passed from call to call in `memory`.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/integrators/control/step_control.h"
#include "engine/integrators/explicit/arrays.h"
#include "engine/integrators/explicit/compensated.h"
#include "engine/integrators/explicit/ias15_nodes.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

constexpr const auto& kNodes = kIas15Nodes;

// Newton's basis: g_k multiplies s (s - s_1) ... (s - s_k); row k holds that product's coefficients of
// s^1 ... s^(k + 1).
constexpr auto kBasis = [] {
  std::array<std::array<double, 7>, 7> c{};
  c[0][0] = 1;
  for (size_t k = 1; k < 7; ++k) {
    for (size_t m = 0; m <= k; ++m) {
      c[k][m] = (m > 0 ? c[k - 1][m - 1] : 0) - (m < k ? kNodes[k] * c[k - 1][m] : 0);
    }
  }
  return c;
}();

constexpr auto kInverseGaps = [] {
  std::array<std::array<double, 8>, 8> r{};
  for (size_t k = 1; k < 8; ++k) {
    for (size_t j = 0; j < k; ++j) r[k][j] = 1 / (kNodes[k] - kNodes[j]);
  }
  return r;
}();

template <size_t M>
class Radau15 final : public Interpolant {
 public:
  explicit Radau15(Advance& in)
      : in_(in),
        second_(*in.f.second_order()),
        m_(M ? M : in.f.size() / 2),
        moving_(second_.depends_on_velocity()),
        a_(in, "integrator.ias15", m_),
        y_(in, "integrator.ias15_y", 2 * m_) {
    std::copy_n(in.y, 2 * m_, y_[kNow]);
    recall();
  }

  void run() {
    const double tolerance = std::max(in_.tolerance.relative, in_.tolerance.absolute);
    const double epsilon =
        tolerance > 1 ? 0.1 * tolerance
                      : std::max(1e-9, 0.1 * step_control::rough_pow(std::max(tolerance, 1e-30), 0.4375));
    double t = in_.t, t_low = 0, h = in_.carry.step > 0 ? in_.carry.step : first_step();
    sample(t, y_[kNow], a_[kA0]);
    if (h_ > 0) predict_next(step_within(in_.t_end - t, h) / h_);
    for (uint64_t tried = 0;; ++tried) {
      if (tried >= in_.max_steps) step_control::too_many_steps(in_, t, h);
      const double left = (in_.t_end - t) - t_low;
      const bool last = h >= left * (1 - 1e-12);
      const double now = step_within(left, h);
      const double error = converge(t, now);
      // |b_6| grows like h^7.
      const double factor = error > 0 ? step_control::rough_pow(epsilon / error, 1.0 / 7) : kGrow;
      if (!(factor > kShrink)) {  // includes a NaN error
        h = now * (factor > 0.05 ? factor : 0.05);
        if (in_.statistics) ++in_.statistics->rejected;
        if (h <= step_control::smallest_step(in_, t)) {
          step_control::give_up(in_, t, h, y_[kNow], y_[kNew], -1);
        }
        predict(h / now);
        continue;
      }
      finish(now);
      if (in_.statistics) ++in_.statistics->steps;
      const double proposal = now * std::min(factor, double{kGrow});
      h = now < h ? std::max(h, proposal) : proposal;
      const TwoSum sum = two_sum(t, now + t_low);
      t_low = sum.low;
      double t1 = last ? in_.t_end : sum.sum;
      auto verdict = StepWatcher::Verdict::go_on;
      h_ = now;
      if (in_.watcher) verdict = in_.watcher->accepted(t, t1, y_[kNew], *this);
      t = t1;
      // The error of the prediction.
      for (size_t k = 0; k < 7; ++k) {
        double *b = a_[kB + k], *e = a_[kE + k];
        loop([=](size_t i) { e[i] = b[i] - e[i]; });
      }
      if (last || verdict == StepWatcher::Verdict::stop) break;
      y_.take(kNow, kNew);
      y_.take(kLow, kLowNew);
      sample(t, y_[kNow], a_[kA0]);
      predict_next(step_within((in_.t_end - t) - t_low, h) / now);
    }
    std::copy_n(y_[kNew], 2 * m_, in_.y);
    remember();
    in_.reached = t;
    in_.carry.step = h;
  }

  void at(double s, double* y) const override {
    for (size_t i = 0; i < m_; ++i) {
      y[i] = y_[kNow][i] + position_change(i, s, h_);
      y[m_ + i] = y_[kNow][m_ + i] + velocity_change(i, s, h_);
    }
  }

 private:
  // g and b: coefficients in Newton's basis and in powers; e: the prediction of b.
  enum : size_t { kA0, kAt, kG, kB = kG + 7, kE = kB + 7, kCount = kE + 7 };
  enum : size_t { kNow, kNew, kLow, kLowNew, kYs };
  static constexpr double kShrink = 0.25, kGrow = 4;

  template <class Body>
  void loop(Body body) const {
    const size_t m = M ? M : m_;
#pragma GCC ivdep
    for (size_t i = 0; i < m; ++i) body(i);
  }

  /// Length of the next step when `left` remains: two equal ones if less than two remain.
  static double step_within(double left, double h) {
    return h >= left * (1 - 1e-12) ? left : 2 * h > left ? 0.5 * left : h;
  }

  // Lower parts and polynomials of the last call, if y has not been changed since.
  void recall() {
    const bool known = recall_sums(in_, y_[kLow]) && in_.memory.size() == ias15_memory(2 * m_);
    const double* from = in_.memory.data() + sums_memory(2 * m_);
    for (size_t k = 0; k < 7; ++k) {
      for (double* to : {a_[kB + k], a_[kE + k]}) {
        if (known) {
          std::copy_n(from, m_, to);
          from += m_;
        } else {
          std::fill_n(to, m_, 0);
        }
      }
    }
    if (known) h_ = from[0], warm_ = from[1] > 0;
  }
  void remember() {
    if (!remember_sums(in_, y_[kLowNew]) || in_.memory.size() != ias15_memory(2 * m_)) return;
    double* to = in_.memory.data() + sums_memory(2 * m_);
    for (size_t k = 0; k < 7; ++k) {
      to = std::copy_n(a_[kB + k], m_, to);
      to = std::copy_n(a_[kE + k], m_, to);
    }
    to[0] = h_, to[1] = warm_ ? 1 : 0;
  }

  void sample(double t, const double* y, double* a) {
    second_.acceleration(t, y, moving_ ? y + m_ : nullptr, a);
    if (in_.statistics) ++in_.statistics->rates;
  }

  double first_step() {
    in_.f.rate(in_.t, in_.y, y_[kNew]);
    if (in_.statistics) in_.statistics->rates += 2;
    Tolerance fine{.relative = 1e-8, .absolute = 1e-8};
    const Advance look{.f = in_.f,
                       .t = in_.t,
                       .t_end = in_.t_end,
                       .y = in_.y,
                       .workspace = in_.workspace,
                       .carry = in_.carry,
                       .tolerance = fine};
    return step_control::first_step(look, y_[kNow], y_[kNew], 15, y_[kLowNew], y_[kYs]);
  }

  double position_change(size_t i, double s, double h) const {
    const auto b = [&](size_t k) { return a_[kB + k][i]; };
    double p = b(6) * (1.0 / 72);
    p = std::fma(s, p, b(5) * (1.0 / 56)), p = std::fma(s, p, b(4) * (1.0 / 42));
    p = std::fma(s, p, b(3) * (1.0 / 30)), p = std::fma(s, p, b(2) * (1.0 / 20));
    p = std::fma(s, p, b(1) * (1.0 / 12)), p = std::fma(s, p, b(0) * (1.0 / 6));
    p = std::fma(s, p, a_[kA0][i] * 0.5);
    return s * h * std::fma(s * h, p, y_[kNow][m_ + i] + y_[kLow][m_ + i]);
  }
  double velocity_change(size_t i, double s, double h) const {
    const auto b = [&](size_t k) { return a_[kB + k][i]; };
    double p = b(6) * (1.0 / 8);
    p = std::fma(s, p, b(5) * (1.0 / 7)), p = std::fma(s, p, b(4) * (1.0 / 6));
    p = std::fma(s, p, b(3) * (1.0 / 5)), p = std::fma(s, p, b(2) * (1.0 / 4));
    p = std::fma(s, p, b(1) * (1.0 / 3)), p = std::fma(s, p, b(0) * 0.5);
    return s * h * std::fma(s, p, a_[kA0][i]);
  }

  // Corrects the b until they no longer change; returns largest |b_6| over largest |a|, or NaN.
  double converge(double t, double h) {
    // g from b: from the highest down.
    for (size_t k = 7; k-- > 0;) {
      const double* b = a_[kB + k];
      double* g = a_[kG + k];
      loop([&](size_t i) {
        double rest = b[i];
        for (size_t l = k + 1; l < 7; ++l) rest -= kBasis[l][k] * a_[kG + l][i];
        g[i] = rest;
      });
    }
    double last_change = 2;
    // Twelve are enough for steps that meet a tolerance; long ones with damping need most.
    for (int round = 0; round < 40; ++round) {
      double* changes = y_[kYs];
      std::fill_n(changes, m_, 0.0);
      double change = 0, most_b = 0, most_a = 0;
      correct<1>(t, h), correct<2>(t, h), correct<3>(t, h), correct<4>(t, h), correct<5>(t, h),
          correct<6>(t, h), correct<7>(t, h);
      const double *b6 = a_[kB + 6], *sampled = a_[kAt];
      double poison = 0;
      for (size_t i = 0; i < m_; ++i) {
        change = std::max(change, changes[i]);
        most_b = std::max(most_b, std::abs(b6[i]));
        most_a = std::max(most_a, std::abs(sampled[i]));
        poison += 0.0 * b6[i] + 0.0 * sampled[i];
      }
      if (poison != 0) return poison;  // not a number
      const double relative = most_a > 0 ? change / most_a : 0;
      last_b_ = most_a > 0 ? most_b / most_a : 0;
      // Converged to rounding, or cycling there; changes that are still larger keep falling.
      constexpr double kNearRounding = 1e-10;
      if (relative < 1e-16 || (round >= 2 && relative >= last_change && relative < kNearRounding)) break;
      last_change = relative;
    }
    return last_b_;
  }

  // Samples node K and adds its information to g_(K-1) and the b.
  template <size_t K>
  void correct(double t, double h) {
    constexpr double s = kNodes[K];
    const double *x = y_[kNow], *v = x + m_;
    double *out = y_[kNew], *out_v = out + m_;
    loop([&](size_t i) { out[i] = x[i] + (y_[kLow][i] + position_change(i, s, h)); });
    if (moving_) loop([&](size_t i) { out_v[i] = v[i] + (y_[kLow][m_ + i] + velocity_change(i, s, h)); });
    double* at = a_[kAt];
    sample(t + s * h, out, at);
    const double* a0 = a_[kA0];
    double *g = a_[kG + K - 1], *changes = y_[kYs];
    loop([&](size_t i) {
      double d = (at[i] - a0[i]) * kInverseGaps[K][0];
      for (size_t j = 1; j < K; ++j) d = (d - a_[kG + j - 1][i]) * kInverseGaps[K][j];
      const double change = d - g[i];
      g[i] = d;
      changes[i] = changes[i] > std::abs(change) ? changes[i] : std::abs(change);
      for (size_t m = 0; m < K; ++m) a_[kB + m][i] += kBasis[K - 1][m] * change;
    });
  }

  void finish(double h) {
    const double *x = y_[kNow], *v = x + m_, *low = y_[kLow], *low_v = low + m_;
    double *out = y_[kNew], *out_v = out + m_, *low_out = y_[kLowNew], *low_v_out = low_out + m_;
    loop([&](size_t i) {
      const TwoSum p = two_sum(x[i], low[i] + position_change(i, 1, h));
      out[i] = p.sum, low_out[i] = p.low;
      const TwoSum q = two_sum(v[i], low_v[i] + velocity_change(i, 1, h));
      out_v[i] = q.sum, low_v_out[i] = q.low;
    });
  }

  // The prediction for a step q times as long from the same start, after the correction failed and left no
  // usable b.
  void predict(double q) {
    double power = q;
    for (size_t k = 0; k < 7; ++k, power *= q) {
      double *b = a_[kB + k], *e = a_[kE + k];
      const double scale = power;
      loop([=](size_t i) { b[i] = e[i] = scale * e[i]; });
    }
  }

  // b of the next step, q times as long as the finished one: the polynomial around its end,
  //   b'_k = q^(k + 1) sum_{l >= k} binomial(l + 1, k + 1) b_l, plus the error of the same rule last time.
  void predict_next(double q) {
    constexpr auto kBinomial = [] {
      std::array<std::array<double, 9>, 9> c{};
      for (size_t n = 0; n < 9; ++n) {
        c[n][0] = 1;
        for (size_t k = 1; k <= n; ++k) c[n][k] = c[n - 1][k - 1] + (k < n ? c[n - 1][k] : 0);
      }
      return c;
    }();
    const bool far = q > 20;  // too far for a prediction
    double power = q;
    for (size_t k = 0; k < 7; ++k, power *= q) {
      double *b = a_[kB + k], *e = a_[kE + k];
      const double scale = far ? 0 : power;
      loop([&](size_t i) {
        double sum = 0;
        for (size_t l = k; l < 7; ++l) sum += kBinomial[l + 1][k + 1] * a_[kB + l][i];
        const double missed = far || !warm_ ? 0 : e[i];
        e[i] = scale * sum;
        b[i] = e[i] + missed;
      });
    }
    warm_ = true;
  }

  Advance& in_;
  const SecondOrder& second_;
  size_t m_;
  bool moving_;
  mutable Arrays<width_of(M), kCount> a_;
  mutable Arrays<width_of(2 * M), kYs + 1> y_;
  double h_ = 0, last_b_ = 0;
  bool warm_ = false;
};

}  // namespace

// Layout: the sums' (compensated.h), then b and e of the last step (7 pairs of n / 2), its length, 1 once
// predictions have been made.
size_t ias15_memory(size_t n) {
  return sums_memory(n) + 7 * n + 2;
}

void prepare_ias15(const ForceField& field, State& state) {
  prepare_adaptive(field, state);
  add_memory(state, ias15_memory(2 * state.f64(state.at("position")).size()));
}

void advance_ias15(Advance& in) {
  with_size<2, 3>(positions_of(in), [&]<size_t M>() { Radau15<M>(in).run(); });
}

}  // namespace truestep
