#include "engine/integrators/explicit/tableau_method.h"

#include <cmath>
#include <span>

namespace truestep {

namespace {

/// Calls run.operator()<n>() for 1 <= n <= the number of stages.
template <class Run>
auto with_count(size_t n, Run run) {
  using Call = decltype(run.template operator()<1>()) (*)(Run&);
  static constexpr auto kCalls = []<size_t... I>(std::index_sequence<I...>) {
    return std::array<Call, sizeof...(I)>{[](Run& r) { return r.template operator()<I + 1>(); }...};
  }
  (std::make_index_sequence<Tableau::kMaxStages>());
  return kCalls[n - 1](run);
}

template <size_t Count>
struct Weighted {
  std::array<double, Count> w;
  std::array<const double*, Count> k;
  double operator()(size_t i) const {
    double sum = w[0] * k[0][i];
#pragma GCC unroll 13
    for (size_t j = 1; j < Count; ++j) sum = std::fma(w[j], k[j][i], sum);
    return sum;
  }
};
template <size_t Count, class Terms>
Weighted<Count> weighted(const Terms& t) {
  Weighted<Count> sum;
  std::copy_n(t.w.begin(), Count, sum.w.begin());
  std::copy_n(t.k.begin(), Count, sum.k.begin());
  return sum;
}

}  // namespace

TableauMethod::TableauMethod(const Tableau& tableau, Advance& in, SumOrder order)
    : tableau_(tableau),
      fsal_(tableau.first_same_as_last()),
      in_(in),
      n_(in.f.size()),
      a_(in, "integrator.pair", n_, order, kK + tableau.stages) {
  std::copy_n(in.y, n_, a_[kY]);
}
TableauMethod::~TableauMethod() {
  if (in_.statistics) in_.statistics->rates += rates_;
}

double TableauMethod::first_step() {
  ++rates_;
  return step_control::first_step(in_, a_[kY], a_[kK], tableau_.order, a_[kStage], a_[kNew]);
}

TableauMethod::Terms TableauMethod::terms(const Tableau::Weights& weights) const {
  Terms t;
  for (size_t j = 0; j < tableau_.stages; ++j) {
    if (weights[j] != 0) t.w[t.n] = weights[j], t.k[t.n] = a_[kK + j], ++t.n;
  }
  return t;
}

void TableauMethod::add(double h, const Terms& sum, const double* y, double* out) const {
  with_count(sum.n, [&]<size_t Count>() {
    a_.loop([h, y, out, increment = weighted<Count>(sum)](size_t i) {
      out[i] = std::fma(h, increment(i), y[i]);
    });
  });
}

bool TableauMethod::step(double t, double h) {
  const size_t last = tableau_.stages - 1;
  for (size_t i = 1; i <= last; ++i) {
    // The last stage of some is at the step's result.
    const bool result = fsal_ && i == last;
    double* out = a_[result ? kNew : kStage];
    add(h, terms(result ? tableau_.b : tableau_.a[i]), a_[kY], out);
    rate(result ? t + h : t + tableau_.c[i] * h, out, a_[kK + i]);
  }
  if (!fsal_) add(h, terms(tableau_.b), a_[kY], a_[kNew]);
  return true;
}

double TableauMethod::attempt(double t, double h) {
  step(t, h);
  double* e = a_[kStage];
  std::fill_n(e, n_, 0.0);
  add(1, terms(tableau_.error), e, e);
  const auto summed = [&](auto floor) {
    return a_.sum([e, y = a_[kY], y_new = a_[kNew], relative = in_.tolerance.relative, floor](size_t i) {
      const double p = std::abs(y[i]), r = std::abs(y_new[i]), size = p > r ? p : r;
      const double q = e[i] / std::fma(relative, size, floor(i));
      return q * q;
    });
  };
  const std::span<const double> each = in_.tolerance.absolute_each;
  const double sum = each.empty() ? summed([absolute = in_.tolerance.absolute](size_t) { return absolute; })
                                  : summed([each = each.data()](size_t i) { return each[i]; });
  return h * h / static_cast<double>(n_) * sum;
}

const Interpolant& TableauMethod::between(double t, double h) {
  h_ = h;
  // Hermite interpolation needs the rate at the end, as does the next step.
  if (!fsal_) rate(t + h, a_[kNew], a_[kLast]), last_stands_ = true;
  return *this;
}
void TableauMethod::accept(double t1) {
  if (fsal_) {
    a_.take(kK, kK + tableau_.stages - 1);
  } else {
    if (!last_stands_) rate(t1, a_[kNew], a_[kLast]);
    last_stands_ = false;
    a_.take(kK, kLast);
  }
  a_.take(kY, kNew);
}
long long TableauMethod::worst(double h) const {
  const Terms error = terms(tableau_.error);
  return step_control::worst_component(in_, n_, a_[kY], [&](size_t i) {
    double sum = error.w[0] * error.k[0][i];
    for (size_t j = 1; j < error.n; ++j) sum = std::fma(error.w[j], error.k[j][i], sum);
    return h * sum;
  });
}

void TableauMethod::at(double theta, double* y) const {
  const double *k0 = a_[kK], *k1 = a_[fsal_ ? kK + tableau_.stages - 1 : size_t{kLast}];
  const double rest = 1 - theta, w = theta * theta * (3 - 2 * theta);
  const double w0 = h_ * theta * rest * rest, w1 = -h_ * theta * theta * rest;
  for (size_t i = 0; i < n_; ++i) {
    y[i] = a_[kY][i] + (w * (a_[kNew][i] - a_[kY][i]) + (w0 * k0[i] + w1 * k1[i]));
  }
}

}  // namespace truestep
