// ssprk104 (tableau.h) on first-order systems in Ketcheson's low-storage form (2008, section 4.2):
//   q = y; five times q += h/6 f(q);  r = (y + 9 q) / 25;  q = 15 r - 5 q;  four times q += h/6 f(q);
//   y' = r + 3/5 q + h/10 f(q).
// Ten stages touch five arrays, so that systems of a few thousand equations stay in the second-level cache;
// the embedded solution is y + h (k_1/5 + 3 k_4/10 + k_7/5 + 3 k_9/10). Small systems use the general path.
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

class LowStorage final : public AdaptiveMethod {
 public:
  explicit LowStorage(Advance& in) : in_(in), n_(in.f.size()), a_(in, "integrator.ssprk104", n_) {
    std::copy_n(in.y, n_, a_[kY]);
  }
  ~LowStorage() override {
    if (in_.statistics) in_.statistics->rates += rates_;
  }

  void begin(double t) override { rate(t, a_[kY], a_[kFirst]); }
  double first_step() override {
    ++rates_;
    return step_control::first_step(in_, a_[kY], a_[kFirst], 4, a_[kNew], a_[kRate]);
  }

  double attempt(double t, double h) override {
    const double *y = a_[kY], *first = a_[kFirst], *k = a_[kRate];
    double *q = a_[kNew], *r = a_[kMiddle], *low = a_[kEmbedded];
    const double sixth = h / 6, fifth = h / 5, three = 0.3 * h;
    a_.loop(
        [=](size_t i) { q[i] = std::fma(sixth, first[i], y[i]), low[i] = std::fma(fifth, first[i], y[i]); });
    const auto forward = [&](double c) {
      rate(t + c * h, q, a_[kRate]);
      a_.loop([=](size_t i) { q[i] = std::fma(sixth, k[i], q[i]); });
    };
    const auto forward_embedded = [&](double c, double w) {
      rate(t + c * h, q, a_[kRate]);
      a_.loop([=](size_t i) { q[i] = std::fma(sixth, k[i], q[i]), low[i] = std::fma(w, k[i], low[i]); });
    };
    forward(1.0 / 6);
    forward(1.0 / 3);
    forward_embedded(0.5, three);
    rate(t + h * (2.0 / 3), q, a_[kRate]);
    a_.loop([=](size_t i) {
      const double p = std::fma(sixth, k[i], q[i]);
      r[i] = 0.04 * y[i] + 0.36 * p;
      q[i] = 15 * r[i] - 5 * p;
    });
    forward(1.0 / 3);
    forward_embedded(0.5, fifth);
    forward(2.0 / 3);
    forward_embedded(5.0 / 6, three);
    rate(t + h, q, a_[kRate]);
    const double tenth = h / 10;
    a_.loop([=](size_t i) { q[i] = std::fma(tenth, k[i], std::fma(0.6, q[i], r[i])); });
    end_stands_ = false;
    return squared_error();
  }

  double* candidate() override { return a_[kNew]; }
  const double* solution() const override { return a_[kY]; }
  const Interpolant& between(double t, double h) override {
    h_ = h;
    end(t + h);
    return *this;
  }
  void accept(double t1) override {
    end(t1);
    a_.exchange(kY, kNew);
    a_.exchange(kFirst, kRate);
  }
  long long worst(double) const override {
    return step_control::worst_component(in_, n_, a_[kY],
                                         [&](size_t i) { return a_[kNew][i] - a_[kEmbedded][i]; });
  }
  void at(double s, double* y) const override {
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < n_; ++i) {
      y[i] = a_[kY][i] + (w * (a_[kNew][i] - a_[kY][i]) + (w0 * a_[kFirst][i] + w1 * a_[kRate][i]));
    }
  }

 private:
  enum : size_t { kY, kNew, kFirst, kRate, kMiddle, kEmbedded, kCount };

  void rate(double t, const double* y, double* k) {
    in_.f.rate(t, y, k);
    ++rates_;
  }
  void end(double t1) {
    if (!end_stands_) rate(t1, a_[kNew], a_[kRate]);
    end_stands_ = true;
  }
  double squared_error() const {
    const double *y = a_[kY], *q = a_[kNew], *low = a_[kEmbedded];
    const Tolerance& tolerance = in_.tolerance;
    const double* each = tolerance.absolute_each.empty() ? nullptr : tolerance.absolute_each.data();
    const double relative = tolerance.relative, absolute = tolerance.absolute;
    const auto term = [=](size_t i, double floor) {
      const double p = std::abs(y[i]), s = std::abs(q[i]), size = p > s ? p : s;
      const double e = (q[i] - low[i]) / std::fma(relative, size, floor);
      return e * e;
    };
    const double sum = each ? a_.sum([=](size_t i) { return term(i, each[i]); })
                            : a_.sum([=](size_t i) { return term(i, absolute); });
    return sum / static_cast<double>(n_);
  }

  Advance& in_;
  size_t n_;
  Arrays<0, kCount> a_;
  uint64_t rates_ = 0;
  double h_ = 0;
  bool end_stands_ = false;
};

}  // namespace

void advance_ssprk104(Advance& in) {
  // When stability limits the step, a stronger proportional part settles it at the limit without rejections,
  // and extrapolating would only disturb it.
  constexpr step_control::Law kLaw{.q = 4, .beta = 0.1, .foresight = 0};
  if (in.f.size() <= 64) return advance_pair<kSsprk104Tableau, Sums::plain, 4, 8>(in, kLaw);
  LowStorage method(in);
  drive<AdaptiveMethod>(in, method, kLaw);
}

}  // namespace truestep
