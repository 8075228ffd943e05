// Steps of an explicit Runge-Kutta method (tableau.h) on y' = f(t, y): stages unrolled at compile time with
// the tableau's numbers as constants, one pass per stage over all terms, oldest first (the older ones are
// summed while the newest stage's evaluation is still in flight). W: elements that loops run over where there
// are few equations, 0 for any number (arrays.h). One virtual call per stage evaluates f. With
// Sums::compensated the solution carries the rounding error of its additions (compensated.h). Numbers read
// from a table at run time took 20 to 160 % more instructions than these constants do.
#pragma once
#include <span>

#include "engine/integrators/explicit/arrays.h"
#include "engine/integrators/explicit/compensated.h"
#include "engine/integrators/explicit/drive.h"
#include "engine/integrators/explicit/tableau_dop853.h"

namespace truestep {

enum class Sums : uint8_t { plain, compensated };

namespace detail {

/// sum_j Weights(j) k(j) over the j < Count whose weight is not 0.
template <auto Weights, size_t Count, class K>
inline double weighted(K k) {
  constexpr size_t kFirst = [] {
    size_t j = 0;
    while (j < Count && Weights(j) == 0) ++j;
    return j;
  }();
  if constexpr (kFirst == Count) {
    return 0;
  } else {
    double sum = Weights(kFirst) * k(kFirst);
    [&]<size_t... J>(std::index_sequence<J...>) {
      const auto add = [&]<size_t j>() {
        if constexpr (j > kFirst && Weights(j) != 0) sum = std::fma(Weights(j), k(j), sum);
      };
      (add.template operator()<J>(), ...);
    }
    (std::make_index_sequence<Count>());
    return sum;
  }
}

}  // namespace detail

template <const Tableau& T, size_t W, Sums sums>
class ExplicitPair final : public Interpolant {
 public:
  static constexpr size_t kStages = T.stages;
  static constexpr bool kFsal = T.first_same_as_last();

  explicit ExplicitPair(Advance& in, SumOrder order = SumOrder::lanes)
      : in_(in),
        n_(in.f.size()),
        a_(in, "integrator.pair", n_, order),
        low_(in, "integrator.pair_low", sums == Sums::compensated ? n_ : 0) {
    std::copy_n(in.y, n_, a_[kY]);
    if (sums == Sums::compensated) recall_sums(in, low_[0]);
  }
  ~ExplicitPair() override {
    if (in_.statistics) in_.statistics->rates += rates_;
  }

  /// Stores the candidate as the result of the call.
  void remember() {
    if (sums == Sums::compensated) remember_sums(in_, low_[1]);
  }

  // --- drive.h

  void begin(double t) { rate(t, a_[kY], a_[kK]); }
  double first_step() {
    ++rates_;
    return step_control::first_step(in_, a_[kY], a_[kK], T.order, a_[kStage], a_[kNew]);
  }
  double attempt(double t, double h) {
    step(t, h);
    return squared_error(h);
  }
  double* candidate() { return a_[kNew]; }
  const double* solution() const { return a_[kY]; }
  const Interpolant& between(double t, double h) {
    t_ = t, h_ = h, dense_stands_ = false;
    // Hermite interpolation needs the rate at the end, as does the next step.
    if constexpr (!kFsal) rate(t + h, a_[kNew], a_[kLast]), last_stands_ = true;
    return *this;
  }
  void accept(double t1) {
    if constexpr (kFsal) {
      a_.take(kK, kK + kStages - 1);
    } else {
      if (!last_stands_) rate(t1, a_[kNew], a_[kLast]);
      last_stands_ = false;
      a_.take(kK, kLast);
    }
    a_.take(kY, kNew);
    if constexpr (sums == Sums::compensated) low_.take(0, 1);
  }
  long long worst(double h) const {
    const auto k = slopes<kStages>();
    return step_control::worst_component(in_, n_, a_[kY], [&](size_t i) { return h * error<kError>(k, i); });
  }

  /// Candidate = one step of length h from the solution; the first stage must be available. Always true.
  bool step(double t, double h) {
    [&]<size_t... I>(std::index_sequence<I...>) {
      (stage<I + 1>(t, h), ...);
    }
    (std::make_index_sequence<kStages - 1>());
    if constexpr (!kFsal) advance_to_candidate(h);
    return true;
  }

  // --- Interpolant

  void at(double theta, double* y) const override {
    if constexpr (T.dense_order == 7) {
      at_order_7(theta, y);
    } else if constexpr (T.dense_order == 4) {
      std::array<double, kStages> b;
      for (size_t j = 0; j < kStages; ++j) {
        const auto& p = T.dense[j];
        b[j] = h_ * (theta * (p[0] + theta * (p[1] + theta * (p[2] + theta * p[3]))));
      }
      for (size_t i = 0; i < n_; ++i) {
        double sum = 0;
        for (size_t j = 0; j < kStages; ++j) sum += b[j] * a_[kK + j][i];
        y[i] = a_[kY][i] + sum;
      }
    } else {
      const double *k0 = a_[kK], *k1 = a_[kFsal ? kK + kStages - 1 : size_t{kLast}];
      const double rest = 1 - theta, w = theta * theta * (3 - 2 * theta);
      const double w0 = h_ * theta * rest * rest, w1 = -h_ * theta * theta * rest;
      for (size_t i = 0; i < n_; ++i) {
        y[i] = a_[kY][i] + (w * (a_[kNew][i] - a_[kY][i]) + (w0 * k0[i] + w1 * k1[i]));
      }
    }
  }

 private:
  static constexpr size_t kExtra = T.dense_order == 7 ? 3 : 0;
  enum : size_t { kY, kNew, kStage, kLast, kK, kCount = kK + kStages + kExtra };
  static constexpr auto kB = [](size_t j) { return T.b[j]; };
  static constexpr auto kError = [](size_t j) { return T.error[j]; };
  static constexpr auto kSecondError = [](size_t j) { return T.second_error[j]; };

  /// The first `Count` stages' rates. Loops capture them by value: a lambda that reads them through `this`
  /// reads the pointers in each iteration and is not vectorised (half the speed of tsit5 on 2,000 equations).
  template <size_t Count>
  std::array<const double*, Count> slopes() const {
    std::array<const double*, Count> k;
    for (size_t j = 0; j < Count; ++j) k[j] = a_[kK + j];
    return k;
  }

  void rate(double t, const double* y, double* k) {
    in_.f.rate(t, y, k);
    ++rates_;
  }

  template <size_t I>
  void stage(double t, double h) {
    if constexpr (kFsal && I == kStages - 1) {
      advance_to_candidate(h);
      rate(t + h, a_[kNew], a_[kK + I]);
    } else {
      const double* y = a_[kY];
      double* out = a_[kStage];
      const auto k = slopes<I>();
      a_.loop([h, y, out, k](size_t i) {
        constexpr auto kRow = [](size_t j) { return T.a[I][j]; };
        out[i] = std::fma(h, detail::weighted<kRow, I>([&](size_t j) { return k[j][i]; }), y[i]);
      });
      rate(t + T.c[I] * h, out, a_[kK + I]);
    }
  }

  void advance_to_candidate(double h) {
    const double* y = a_[kY];
    double* out = a_[kNew];
    const auto increment = [k = slopes<kStages>()](size_t i) {
      return detail::weighted<kB, kStages>([&](size_t j) { return k[j][i]; });
    };
    if constexpr (sums == Sums::compensated) {
      const double* low = low_[0];
      double* low_out = low_[1];
      a_.loop([=](size_t i) {
        const TwoSum s = two_sum(y[i], std::fma(h, increment(i), low[i]));
        out[i] = s.sum, low_out[i] = s.low;
      });
    } else {
      a_.loop([=](size_t i) { out[i] = std::fma(h, increment(i), y[i]); });
    }
  }

  template <auto Weights>
  static double error(const std::array<const double*, kStages>& k, size_t i) {
    return detail::weighted<Weights, kStages>([&](size_t j) { return k[j][i]; });
  }

  double squared_error(double h) const {
    const double *y = a_[kY], *y_new = a_[kNew];
    const double relative = in_.tolerance.relative, absolute = in_.tolerance.absolute;
    const auto k = slopes<kStages>();
    const auto norm = [&]<auto Weights>() {
      const auto summed = [&](auto floor) {
        return a_.sum([=](size_t i) {
          const double p = std::abs(y[i]), r = std::abs(y_new[i]), size = p > r ? p : r;
          const double q = error<Weights>(k, i) / std::fma(relative, size, floor(i));
          return q * q;
        });
      };
      const std::span<const double> each = in_.tolerance.absolute_each;
      if (each.empty()) return summed([absolute](size_t) { return absolute; });
      // Few are asked of the zeros behind them as well.
      std::array<double, (W > 0 ? W : kMostHalved)> few{};
      if (W > 0 || n_ <= few.size()) std::ranges::copy(each, few.begin());
      return summed(
          [floor = W > 0 || n_ <= few.size() ? few.data() : each.data()](size_t i) { return floor[i]; });
    };
    const double first = norm.template operator()<kError>(), scale = h * h / static_cast<double>(n_);
    if constexpr (T.two_errors()) {
      const double second = norm.template operator()<kSecondError>();
      const double both = first + 0.01 * second;
      return both > 0 ? scale * first * (first / both) : both;
    } else {
      return scale * first;
    }
  }

  void at_order_7(double theta, double* y) const {
    if (!dense_stands_) evaluate_dense_stages();
    dop853_between(n_, h_, theta, a_[kY], a_[kNew], slopes<kStages + kExtra>().data(), y);
  }
  void evaluate_dense_stages() const {
    for (size_t e = 0; e < kExtra; ++e) {
      dop853_dense_stage(e, n_, h_, a_[kY], slopes<kStages + kExtra>().data(), a_[kStage]);
      in_.f.rate(t_ + kDop853Dense.c[e] * h_, a_[kStage], a_[kK + kStages + e]);
      ++rates_;
    }
    dense_stands_ = true;
  }

  Advance& in_;
  size_t n_;
  mutable Arrays<W, kCount> a_;
  Arrays<W, 2> low_;
  mutable uint64_t rates_ = 0;
  double t_ = 0, h_ = 0;
  mutable bool dense_stands_ = false;
  bool last_stands_ = false;
};

/// One integration with the pair, compiled for any number of equations and, where these are added in halves,
/// for those that Widths are right for: a width costs a third of a second of the compiler's time, and without
/// it a step of six cheap equations took 15 to 25 % more instructions, one of twelve 7 to 14 %.
template <const Tableau& T, Sums sums, size_t... Widths>
void advance_pair(Advance& in, const step_control::Law& law) {
  const SumOrder order = order_of_sums(in.f.size());
  const auto run = [&]<size_t W>() {
    ExplicitPair<T, W, sums> pair(in, order);
    drive(in, pair, law);
    pair.remember();
  };
  if (order == SumOrder::lanes) return run.template operator()<0>();
  with_width<Widths...>(in.f.size(), run);
}

}  // namespace truestep
