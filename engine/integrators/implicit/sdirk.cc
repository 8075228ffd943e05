// Singly diagonally implicit Runge-Kutta methods (dirk_tableau.h). Every stage is a system
//   Y = base + h gamma f(t + c h, Y)
// solved by Newton's method with one Jacobian per step or less (stage_solver.h). Stage rates are (Y - base) /
// (h gamma), which damps errors that f would amplify. Error estimates are filtered, (I - h gamma J)^-1 h
// sum_i e_i k_i, so that stiff components do not inflate them (Hosea, Shampine 1996, section 3; Hairer,
// Wanner 1996, eq. IV.8.20).
#include "engine/integrators/equations.h"
#include "engine/integrators/explicit/drive_fixed.h"
#include "engine/integrators/implicit/dirk_tableau.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/stage_solver.h"

namespace truestep {

namespace {

class Dirk final : public AdaptiveMethod {
 public:
  using By = StageSolver::Scale::By;
  /// `scale`: by the tolerance for steps that may be shortened, by the solution for fixed ones.
  Dirk(const DirkTableau& tableau, Equations& eq, By scale)
      : tableau_(tableau),
        explicit_first_(tableau.explicit_first()),
        stiffly_accurate_(tableau.stiffly_accurate()),
        eq_(eq),
        solver_(eq, scale) {
    std::copy_n(eq.advance().y, eq.size(), eq.array(y_));
  }

  // --- drive.h

  void begin(double t) override { eq_.rate(t, eq_.array(y_), eq_.array(kRate)); }
  double first_step() override {
    eq_.count().rates += 1;
    return step_control::first_step(eq_.advance(), eq_.array(y_), eq_.array(kRate), tableau_.order,
                                    eq_.array(kBase), eq_.array(kIncrement));
  }
  /// A failed iteration counts as an error that makes the next step a quarter as long.
  double attempt(double t, double h) override {
    if (!step(t, h)) return tableau_.error_order == 4 ? 3e4 : 4e3;  // (0.9 / 0.25)^(2 order)
    double* e = eq_.array(kIncrement);
    Row weights{};
    for (size_t i = 0; i < tableau_.stages; ++i) weights[i] = h * tableau_.error[i];
    combine(eq_, e, nullptr, weights.data(), kStages, tableau_.stages);
    eq_.solve(e);
    const double error = eq_.norm(e, eq_.array(y_), eq_.array(1 - y_));
    return error * error;
  }
  double* candidate() override { return eq_.array(1 - y_); }
  const double* solution() const override { return eq_.array(y_); }
  const Interpolant& between(double t, double h) override {
    t_ = t, h_ = h;
    end_stands_ = false;
    return *this;
  }
  void accept(double t1) override {
    y_ = 1 - y_;
    solver_.step_accepted();
    if (stiffly_accurate_) {
      std::copy_n(eq_.array(kStages + tableau_.stages - 1), eq_.padded(), eq_.array(kRate));
    } else {
      eq_.rate(t1, eq_.array(y_), eq_.array(kRate));
    }
  }
  long long worst(double) const override {
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
    const double* k1 = eq_.array(kStages + tableau_.stages - 1);
    if (!stiffly_accurate_) {
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
      if (!solver_.prepare(t, eq_.array(y_), eq_.array(kRate), h * tableau_.gamma)) return false;
      if (stages(t, h)) return true;
    } while (solver_.try_again());
    return false;
  }

 private:
  using Row = DirkTableau::Row;
  // Arrays 0 and 1: the solution at both ends of a step, alternating.
  enum : size_t { kRate = 2, kBase, kIncrement, kEndRate, kStages };

  bool stages(double t, double h) {
    double* const y_new = eq_.array(1 - y_);
    const size_t n = eq_.padded();
    const double z = h * tableau_.gamma;
    for (size_t i = 0; i < tableau_.stages; ++i) {
      double* k = eq_.array(kStages + i);
      if (i == 0 && explicit_first_) {
        std::copy_n(eq_.array(kRate), n, k);
        continue;
      }
      double* const base = eq_.array(kBase);
      Row weights{};
      for (size_t j = 0; j < i; ++j) weights[j] = h * tableau_.a[i][j];
      combine(eq_, base, eq_.array(y_), weights.data(), kStages, i);
      const double* guess = i == 0 ? eq_.array(kRate) : eq_.array(kStages + i - 1);
      for (size_t m = 0; m < n; ++m) y_new[m] = base[m] + z * guess[m];
      if (!solver_.solve(t + tableau_.c[i] * h, base, z, y_new, eq_.array(kIncrement))) return false;
      const double inverse = 1 / z;
      for (size_t m = 0; m < n; ++m) k[m] = (y_new[m] - base[m]) * inverse;
    }
    if (!stiffly_accurate_) {
      Row weights{};
      for (size_t i = 0; i < tableau_.stages; ++i) weights[i] = h * tableau_.b[i];
      combine(eq_, y_new, eq_.array(y_), weights.data(), kStages, tableau_.stages);
    }
    return true;
  }

  const DirkTableau& tableau_;
  bool explicit_first_, stiffly_accurate_;
  Equations& eq_;
  StageSolver solver_;
  size_t y_ = 0;
  double t_ = 0, h_ = 0;
  mutable bool end_stands_ = false;
};

void advance_adaptive(Advance& a, const DirkTableau& tableau) {
  with_equations(a, [&](Equations& eq) {
    Dirk method(tableau, eq, Dirk::By::tolerance);
    drive<AdaptiveMethod>(a, method, {.q = double(tableau.error_order), .beta = 0.04, .grow = 6});
  });
}

void advance_fixed(Advance& a, const DirkTableau& tableau) {
  with_equations(a, [&](Equations& eq) {
    Dirk method(tableau, eq, Dirk::By::solution);
    drive_fixed(a, method);
  });
}

}  // namespace

void advance_sdirk4(Advance& a) {
  advance_adaptive(a, kSdirk4);
}
void advance_tr_bdf2(Advance& a) {
  advance_adaptive(a, kTrBdf2);
}
void advance_tr_bdf2_fixed(Advance& a) {
  advance_fixed(a, kTrBdf2);
}
void advance_implicit_euler(Advance& a) {
  advance_fixed(a, kImplicitEuler);
}
void advance_implicit_midpoint(Advance& a) {
  advance_fixed(a, kImplicitMidpoint);
}
void advance_trapezoid(Advance& a) {
  advance_fixed(a, kTrapezoid);
}

}  // namespace truestep
