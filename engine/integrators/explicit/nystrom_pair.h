// Steps of a Runge-Kutta-Nystroem pair (tableau_nystrom.h) on x'' = a(t, x), y = (x, v): half the arrays of a
// Runge-Kutta method and fewer stages for the same order. Sums of x and v are compensated (compensated.h):
// the orders are meant for errors near rounding. M = length of x where known at compile time, else 0.
// Between the ends of a step: quintic Hermite interpolation of x, v and a (x of order 6, v of order 5).
#pragma once
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/explicit/tableau_nystrom.h"

namespace truestep {

template <const NystromTableau& T, size_t M>
class NystromPair final : public Interpolant {
 public:
  static constexpr size_t kStages = T.stages;
  static constexpr bool kFsal = T.first_same_as_last();

  NystromPair(Advance& in, SumOrder order)
      : in_(in),
        second_(*in.f.second_order()),
        m_(M ? M : in.f.size() / 2),
        y_(in, "integrator.nystrom_y", 2 * m_),
        k_(in, "integrator.nystrom_k", m_, order) {
    std::copy_n(in.y, 2 * m_, y_[kNow]);
    recall_sums(in, y_[kLow]);
  }
  /// Stores the candidate as the result of the call.
  void remember() { remember_sums(in_, y_[kLowNew]); }
  ~NystromPair() override {
    if (in_.statistics) in_.statistics->rates += rates_;
  }

  void begin(double t) { acceleration(t, y_[kNow], k_[0]); }
  double first_step() {
    in_.f.rate(in_.t, y_[kNow], y_[kNew]);
    rates_ += 2;
    return step_control::first_step(in_, y_[kNow], y_[kNew], T.order, y_[kLowNew], y_[kScratch]);
  }
  double attempt(double t, double h) {
    [&]<size_t... I>(std::index_sequence<I...>) {
      (stage<I + 1>(t, h), ...);
    }
    (std::make_index_sequence<kStages - (kFsal ? 2 : 1)>());
    advance_to_candidate(h);
    if constexpr (kFsal) acceleration(t + h, y_[kNew], k_[kStages - 1]);
    end_stands_ = kFsal;
    return squared_error(h);
  }
  double* candidate() { return y_[kNew]; }
  const double* solution() const { return y_[kNow]; }
  const Interpolant& between(double t, double h) {
    h_ = h;
    end(t + h);
    return *this;
  }
  void accept(double t1) {
    end(t1);
    k_.take(0, kEnd);
    y_.take(kNow, kNew);
    y_.take(kLow, kLowNew);
  }
  long long worst(double h) const {
    return step_control::worst_component(in_, 2 * m_, y_[kNow], [&](size_t i) {
      return i < m_ ? h * h * sum<kError>(i) : h * sum<kErrorV>(i - m_);
    });
  }

  void at(double s, double* y) const override {
    const double s2 = s * s, s3 = s2 * s;
    const double x1 = s3 * (10 + s * (-15 + 6 * s)), v1 = s3 * (-4 + s * (7 - 3 * s)),
                 v0 = s + s3 * (-6 + s * (8 - 3 * s)), a0 = 0.5 * s2 * (1 + s * (-3 + s * (3 - s))),
                 a1 = 0.5 * s3 * (1 + s * (-2 + s));
    const double dx = s2 * (30 + s * (-60 + 30 * s)), dv1 = s2 * (-12 + s * (28 - 15 * s)),
                 dv0 = 1 + s2 * (-18 + s * (32 - 15 * s)), da0 = s * (1 + s * (-4.5 + s * (6 - 2.5 * s))),
                 da1 = s2 * (1.5 + s * (-4 + 2.5 * s));
    const double *p = y_[kNow], *q = y_[kNew], *k = k_[0], *l = k_[kEnd];
    for (size_t i = 0; i < m_; ++i) {
      const double rise = q[i] - p[i], w = p[m_ + i], u = q[m_ + i];
      y[i] = p[i] + (x1 * rise + h_ * (v0 * w + v1 * u + h_ * (a0 * k[i] + a1 * l[i])));
      y[m_ + i] = dx * rise / h_ + dv0 * w + dv1 * u + h_ * (da0 * k[i] + da1 * l[i]);
    }
  }

 private:
  enum : size_t { kNow, kNew, kLow, kLowNew, kScratch, kArrays };
  static constexpr size_t kEnd = kFsal ? kStages - 1 : kStages;  // the acceleration at the step's end
  static constexpr auto kB = [](size_t j) { return T.b[j]; };
  static constexpr auto kBv = [](size_t j) { return T.bv[j]; };
  static constexpr auto kError = [](size_t j) { return T.error[j]; };
  static constexpr auto kErrorV = [](size_t j) { return T.error_v[j]; };

  void acceleration(double t, const double* x, double* a) {
    second_.acceleration(t, x, nullptr, a);
    ++rates_;
  }
  void end(double t1) {
    if (!end_stands_) acceleration(t1, y_[kNew], k_[kEnd]);
    end_stands_ = true;
  }

  template <class Body>
  void loop(Body body) const {
    const size_t m = M ? M : m_;
#pragma GCC ivdep
    for (size_t i = 0; i < m; ++i) body(i);
  }
  template <auto Weights>
  double sum(size_t i) const {
    return detail::weighted<Weights, kStages>([&](size_t j) { return k_[j][i]; });
  }

  template <size_t I>
  void stage(double t, double h) {
    constexpr auto kRow = [](size_t j) { return T.a[I][j]; };
    const double *x = y_[kNow], *v = x + m_;
    double* out = y_[kScratch];
    loop([&](size_t i) {
      const double s = detail::weighted<kRow, I>([&](size_t j) { return k_[j][i]; });
      // c v + h s before the last multiplication by h.
      out[i] = std::fma(h, std::fma(h, s, T.c[I] * v[i]), x[i]);
    });
    acceleration(t + T.c[I] * h, out, k_[I]);
  }

  void advance_to_candidate(double h) {
    const double *x = y_[kNow], *v = x + m_, *low = y_[kLow], *low_v = low + m_;
    double *x_new = y_[kNew], *v_new = x_new + m_, *low_new = y_[kLowNew], *low_v_new = low_new + m_;
    loop([&](size_t i) {
      const TwoSum s = two_sum(x[i], std::fma(h, std::fma(h, sum<kB>(i), v[i] + low_v[i]), low[i]));
      x_new[i] = s.sum, low_new[i] = s.low;
      const TwoSum u = two_sum(v[i], std::fma(h, sum<kBv>(i), low_v[i]));
      v_new[i] = u.sum, low_v_new[i] = u.low;
    });
  }

  double squared_error(double h) const {
    const double *y = y_[kNow], *y_new = y_[kNew];
    const Tolerance& tolerance = in_.tolerance;
    const double* each = tolerance.absolute_each.empty() ? nullptr : tolerance.absolute_each.data();
    const auto term = [&](size_t i, double e) {
      const double p = std::abs(y[i]), r = std::abs(y_new[i]), size = p > r ? p : r;
      const double q = e / std::fma(tolerance.relative, size, each ? each[i] : tolerance.absolute);
      return q * q;
    };
    const double total = k_.sum([&](size_t i) {
      // The zeros behind the last element of few are asked as well.
      if (M > 0 && i >= M) return 0.0;
      return term(i, h * sum<kError>(i)) + term(m_ + i, sum<kErrorV>(i));
    });
    return h * h * total / static_cast<double>(2 * m_);
  }

  Advance& in_;
  const SecondOrder& second_;
  size_t m_;
  mutable Arrays<width_of(2 * M), kArrays, 2 * M> y_;
  mutable Arrays<width_of(M), kStages + 1, M> k_;
  uint64_t rates_ = 0;
  double h_ = 0;
  bool end_stands_ = false;
};

template <const NystromTableau& T>
void advance_nystrom(Advance& in, const step_control::Law& law) {
  const size_t m = positions_of(in);
  with_size<2, 3>(m, [&]<size_t M>() {
    NystromPair<T, M> pair(in, m <= 3 || m == 6 ? SumOrder::halves : SumOrder::lanes);
    drive(in, pair, law);
    pair.remember();
  });
}

}  // namespace truestep
