// Rosenbrock methods: one Newton step per stage, with the Jacobian of the step's start, in place of the
// stages' equations; no iteration, nothing to converge. Tableaus in rosenbrock_tableau.h. If f depends on t,
// df/dt comes from one forward difference per step.
#include "engine/integrators/implicit/rosenbrock_tableau.h"

#include "engine/integrators/explicit/drive.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/small_equations.h"

namespace truestep {

namespace {

template <const RosenbrockTableau& T, class Equations>
class Rosenbrock final : public Interpolant {
 public:
  explicit Rosenbrock(Equations& eq) : eq_(eq), autonomous_(eq.f().autonomous()) {
    std::copy_n(eq.advance().y, eq.size(), eq.array(y_));
  }

  // --- drive.h

  void begin(double t) { eq_.rate(t, eq_.array(y_), eq_.array(kRate)); }
  double first_step() {
    eq_.count().rates += 1;
    return step_control::first_step(eq_.advance(), eq_.array(y_), eq_.array(kRate), T.order,
                                    eq_.array(kArgument), eq_.array(kTime));
  }
  double attempt(double t, double h) {
    const size_t n = eq_.padded();
    double* const y = eq_.array(y_);
    double* const y_new = eq_.array(1 - y_);
    if (!linearised_) linearise(t, h);
    const double z = h * T.gamma;
    if (!eq_.factor(z)) return kFailed;
    const double* rate = eq_.array(kRate);
    double* const argument = eq_.array(kArgument);
    for (size_t i = 0; i < T.stages; ++i) {
      double* u = eq_.array(kStages + i);
      if (i > 0) {
        combine(eq_, argument, y, T.a[i].data(), kStages, i);
        eq_.rate(t + T.alpha[i] * h, argument, eq_.array(kStageRate));
        rate = eq_.array(kStageRate);
      }
      // z times the right-hand side.
      combine(eq_, u, nullptr, kScaledC[i].data(), kStages, i);
      if (!autonomous_ && T.d[i] != 0) {
        const double* time = eq_.array(kTime);
        const double w = z * h * T.d[i];
        for (size_t k = 0; k < n; ++k) u[k] += z * rate[k] + w * time[k];
      } else {
        for (size_t k = 0; k < n; ++k) u[k] += z * rate[k];
      }
      eq_.solve(u);
    }
    if constexpr (kLastStageIsError) {
      const double* u = eq_.array(kStages + T.stages - 1);
      for (size_t k = 0; k < n; ++k) y_new[k] = argument[k] + u[k];
    } else {
      combine(eq_, y_new, y, T.m.data(), kStages, T.stages);
      combine(eq_, argument, nullptr, T.e.data(), kStages, T.stages);
    }
    const double error = eq_.norm(this->error(), y, y_new);
    return error * error;
  }
  double* candidate() { return eq_.array(1 - y_); }
  const double* solution() const { return eq_.array(y_); }
  const Interpolant& between(double, double) { return *this; }
  void accept(double t1) {
    y_ = 1 - y_;
    linearised_ = false;
    eq_.rate(t1, eq_.array(y_), eq_.array(kRate));
  }
  long long worst(double) const {
    size_t most = 0;
    double largest = -1;
    for (size_t i = 0; i < eq_.size(); ++i) {
      const double q =
          std::abs(error()[i]) / step_control::weight(eq_.advance().tolerance, i, eq_.array(y_)[i]);
      if (q > largest) largest = q, most = i;
    }
    return static_cast<long long>(most);
  }

  // --- Interpolant: order 4

  void at(double s, double* out) const override {
    const double *y = eq_.array(y_), *y1 = eq_.array(1 - y_);
    for (size_t k = 0; k < eq_.size(); ++k) {
      double inner = 0;
      for (size_t r = T.dense_terms; r-- > 0;) {
        double term = 0;
        for (size_t j = 0; j < T.stages; ++j) term += T.dense[r][j] * eq_.array(kStages + j)[k];
        inner = term + s * inner;
      }
      out[k] = (1 - s) * y[k] + s * (y1[k] + (1 - s) * inner);
    }
  }

 private:
  // Arrays 0 and 1: the solution at both ends of a step, alternating.
  enum : size_t { kRate = 2, kStageRate, kArgument, kTime, kStages };
  static constexpr double kFailed = 1e6;
  // Stiffly accurate with the last increment as error estimate: y1 = last stage's argument + last u.
  static constexpr bool kLastStageIsError = [] {
    for (size_t j = 0; j < T.stages; ++j) {
      const bool last = j + 1 == T.stages;
      if (T.m[j] != (last ? 1 : T.a[T.stages - 1][j]) || T.e[j] != (last ? 1 : 0)) return false;
    }
    return true;
  }();
  static constexpr auto kScaledC = [] {
    auto c = T.c;
    for (auto& row : c) {
      for (double& x : row) x *= T.gamma;
    }
    return c;
  }();

  const double* error() const { return eq_.array(kLastStageIsError ? kStages + T.stages - 1 : kArgument); }

  void linearise(double t, double h) {
    const double *y = eq_.array(y_), *rate = eq_.array(kRate);
    eq_.differentiate(t, y, rate);
    if (!autonomous_) {
      double* time = eq_.array(kTime);
      const double later = t + 0x1p-26 * std::max(std::abs(t), h), inverse = 1 / (later - t);
      eq_.rate(later, y, time);
      for (size_t k = 0; k < eq_.size(); ++k) time[k] = (time[k] - rate[k]) * inverse;
    }
    linearised_ = true;
  }

  Equations& eq_;
  bool autonomous_, linearised_ = false;
  size_t y_ = 0;
};

// Known sizes take 14 to 33 % less time than any size, 5 % less of 8 equations
// (tests/bench/work_precision.py).
template <const RosenbrockTableau& T>
void advance_rosenbrock(Advance& a) {
  visit_equations<1, 2, 3, 4, 8>(a, [&](auto& eq) {
    Rosenbrock<T, std::remove_reference_t<decltype(eq)>> method(eq);
    drive(a, method, {.q = double(T.order), .beta = 0, .grow = 6});
  });
}

}  // namespace

void advance_rodas5p(Advance& a) {
  advance_rosenbrock<kRodas5p>(a);
}

}  // namespace truestep
