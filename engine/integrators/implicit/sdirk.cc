// Singly diagonally implicit Runge-Kutta methods (dirk_tableau.h). Every stage is a system
//   Y = base + h gamma f(t + c h, Y)
// solved by Newton's method with one Jacobian per step or less (stage_solver.h). Stage rates are (Y - base) /
// (h gamma), which damps errors that f would amplify. Error estimates are filtered, (I - h gamma J)^-1 h
// sum_i e_i k_i, so that stiff components do not inflate them (Hosea, Shampine 1996, section 3; Hairer,
// Wanner 1996, eq. IV.8.20).
#include "engine/integrators/equations.h"
#include "engine/integrators/implicit/dirk_tableau.h"
#include "engine/integrators/implicit/drive_fixed.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/stage_solver.h"

namespace truestep {

namespace {

template <const DirkTableau& T, class Equations>
class Dirk final : public Interpolant {
 public:
  using Scale = IncrementScale<Equations>;
  /// `scale`: by the tolerance for steps that may be shortened, by the solution for fixed ones.
  Dirk(Equations& eq, typename Scale::By scale) : eq_(eq), solver_(eq, scale) {
    std::copy_n(eq.advance().y, eq.size(), eq.array(y_));
  }

  // --- drive.h

  void begin(double t) { eq_.rate(t, eq_.array(y_), eq_.array(kRate)); }
  double first_step() {
    eq_.count().rates += 1;
    return step_control::first_step(eq_.advance(), eq_.array(y_), eq_.array(kRate), T.order, eq_.array(kBase),
                                    eq_.array(kIncrement));
  }
  /// A failed iteration counts as an error that makes the next step a quarter as long.
  double attempt(double t, double h) {
    if (!step(t, h)) return kFailed;
    double* e = eq_.array(kIncrement);
    Row weights{};
    for (size_t i = 0; i < T.stages; ++i) weights[i] = h * T.error[i];
    combine(eq_, e, nullptr, weights.data(), kStages, T.stages);
    eq_.solve(e);
    const double error = eq_.norm(e, eq_.array(y_), eq_.array(1 - y_));
    return error * error;
  }
  double* candidate() { return eq_.array(1 - y_); }
  const double* solution() const { return eq_.array(y_); }
  const Interpolant& between(double t, double h) {
    t_ = t, h_ = h;
    end_stands_ = false;
    return *this;
  }
  void accept(double t1) {
    y_ = 1 - y_;
    solver_.step_accepted();
    if constexpr (T.stiffly_accurate()) {
      std::copy_n(eq_.array(kStages + T.stages - 1), eq_.padded(), eq_.array(kRate));
    } else {
      eq_.rate(t1, eq_.array(y_), eq_.array(kRate));
    }
  }
  long long worst(double) const {
    size_t most = 0;
    double largest = -1;
    for (size_t i = 0; i < eq_.size(); ++i) {
      const double q = std::abs(eq_.array(kIncrement)[i]) /
                       step_control::weight(eq_.advance().tolerance, i, eq_.array(y_)[i]);
      if (q > largest) largest = q, most = i;
    }
    return static_cast<long long>(most);
  }

  // --- Interpolant: Hermite, order 3

  void at(double s, double* out) const override {
    const double *y0 = eq_.array(y_), *y1 = eq_.array(1 - y_), *k0 = eq_.array(kRate);
    const double* k1 = eq_.array(kStages + T.stages - 1);
    if constexpr (!T.stiffly_accurate()) {
      k1 = eq_.array(kEndRate);
      if (!end_stands_) eq_.rate(t_ + h_, y1, eq_.array(kEndRate)), end_stands_ = true;
    }
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < eq_.size(); ++i) {
      out[i] = y0[i] + (w * (y1[i] - y0[i]) + (w0 * k0[i] + w1 * k1[i]));
    }
  }

  /// Candidate = one step from the solution; false when Newton's method fails even with a new Jacobian.
  bool step(double t, double h) {
    do {
      if (!solver_.prepare(t, eq_.array(y_), eq_.array(kRate), h * T.gamma)) return false;
      if (stages(t, h)) return true;
    } while (solver_.try_again());
    return false;
  }

 private:
  using Row = DirkTableau::Row;
  // Arrays 0 and 1: the solution at both ends of a step, alternating.
  enum : size_t { kRate = 2, kBase, kIncrement, kEndRate, kStages };
  static constexpr double kFailed = T.error_order == 4 ? 3e4 : 4e3;  // (0.9 / 0.25)^(2 order)

  bool stages(double t, double h) {
    double* const y_new = eq_.array(1 - y_);
    const size_t n = eq_.padded();
    const double z = h * T.gamma;
    for (size_t i = 0; i < T.stages; ++i) {
      double* k = eq_.array(kStages + i);
      if (i == 0 && T.explicit_first()) {
        std::copy_n(eq_.array(kRate), n, k);
        continue;
      }
      double* const base = eq_.array(kBase);
      Row weights{};
      for (size_t j = 0; j < i; ++j) weights[j] = h * T.a[i][j];
      combine(eq_, base, eq_.array(y_), weights.data(), kStages, i);
      const double* guess = i == 0 ? eq_.array(kRate) : eq_.array(kStages + i - 1);
      for (size_t m = 0; m < n; ++m) y_new[m] = base[m] + z * guess[m];
      if (!solver_.solve(t + T.c[i] * h, base, z, y_new, eq_.array(kIncrement))) return false;
      const double inverse = 1 / z;
      for (size_t m = 0; m < n; ++m) k[m] = (y_new[m] - base[m]) * inverse;
    }
    if constexpr (!T.stiffly_accurate()) {
      Row weights{};
      for (size_t i = 0; i < T.stages; ++i) weights[i] = h * T.b[i];
      combine(eq_, y_new, eq_.array(y_), weights.data(), kStages, T.stages);
    }
    return true;
  }

  Equations& eq_;
  StageSolver<Equations> solver_;
  size_t y_ = 0;
  double t_ = 0, h_ = 0;
  mutable bool end_stands_ = false;
};

template <const DirkTableau& T>
void advance_adaptive(Advance& a) {
  visit_equations(a, [&](auto& eq) {
    using Method = Dirk<T, std::remove_reference_t<decltype(eq)>>;
    Method method(eq, Method::Scale::By::tolerance);
    drive(a, method, {.q = double(T.error_order), .beta = 0.04, .grow = 6});
  });
}

template <const DirkTableau& T>
void advance_fixed(Advance& a) {
  visit_equations(a, [&](auto& eq) {
    using Method = Dirk<T, std::remove_reference_t<decltype(eq)>>;
    Method method(eq, Method::Scale::By::solution);
    drive_fixed(a, method);
  });
}

}  // namespace

void advance_sdirk4(Advance& a) {
  advance_adaptive<kSdirk4>(a);
}
void advance_tr_bdf2(Advance& a) {
  advance_adaptive<kTrBdf2>(a);
}
void advance_tr_bdf2_fixed(Advance& a) {
  advance_fixed<kTrBdf2>(a);
}
void advance_implicit_euler(Advance& a) {
  advance_fixed<kImplicitEuler>(a);
}
void advance_implicit_midpoint(Advance& a) {
  advance_fixed<kImplicitMidpoint>(a);
}
void advance_trapezoid(Advance& a) {
  advance_fixed<kTrapezoid>(a);
}

}  // namespace truestep
