#include "engine/integrators/implicit/newton/stage_solver.h"

namespace truestep {

namespace {
constexpr double kSlowConvergence = 0.05, kShortest = 1e-3;
constexpr int kMostNewtonIterations = 50;
enum : size_t { kTrial = kWorkArrays - 2, kNext };
}  // namespace

StageSolver::StageSolver(Equations& eq, Scale::By by) : eq_(eq), scale_(eq, by) {
  if (second_order() && !scale_.shortens_steps()) second_order()->reserve_stage();
}

bool StageSolver::prepare(double t, const double* y, const double* rate, double z) {
  if (!linearised_) {
    eq_.differentiate(t, y, rate);
    linearised_ = fresh_ = true;
    factored_ = 0;
  }
  if (factored_ == z) return true;
  factored_ = 0;
  if (!eq_.factor(z)) return false;
  factored_ = z;
  return true;
}

bool StageSolver::solve(double t, const double* base, double z, double* y, double* d) {
  if (whole_) return newton(t, base, z, y, d) || own_method(t, base, z, y);
  const size_t n = eq_.padded();
  Convergence convergence(scale_.most_iterations());
  for (;;) {
    eq_.rate(t, y, d);
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) d[i] = (base[i] - y[i]) + z * d[i];
    eq_.solve(d);
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) y[i] += d[i];
    const auto verdict = convergence.judge(scale_(d, y));
    if (verdict == Convergence::Verdict::failed) return false;
    if (verdict == Convergence::Verdict::done) break;
  }
  slowest_ = std::max(slowest_, convergence.theta());
  return true;
}

bool StageSolver::try_again() {
  if (fresh_ && (whole_ || scale_.shortens_steps())) return false;
  whole_ = fresh_;
  linearised_ = false;
  return true;
}

void StageSolver::step_accepted() {
  fresh_ = false;
  if (slowest_ > kSlowConvergence || whole_) linearised_ = false;
  slowest_ = 0;
  whole_ = false;
}

bool StageSolver::newton(double t, const double* base, double z, double* y, double* d) {
  const size_t n = eq_.padded();
  double *trial = eq_.array(kTrial), *next = eq_.array(kNext);
  const auto increment = [&](const double* at, double* rate) {
    for (size_t i = 0; i < n; ++i) rate[i] = (base[i] - at[i]) + z * rate[i];
    eq_.solve(rate);
  };
  for (int k = 0; k < kMostNewtonIterations; ++k) {
    eq_.rate(t, y, d);
    eq_.differentiate(t, y, d);
    factored_ = 0;
    if (!eq_.factor(z)) return false;
    factored_ = z;
    increment(y, d);
    const double size = scale_(d, y);
    for (double share = 1;; share *= 0.5) {
      if (!(share > kShortest)) return false;
      for (size_t i = 0; i < n; ++i) trial[i] = y[i] + share * d[i];
      if (size <= 1) break;
      eq_.rate(t, trial, next);
      increment(trial, next);
      if (scale_(next, y) <= (1 - 0.25 * share) * size) break;
    }
    std::copy_n(trial, n, y);
    if (size <= 1) return true;
  }
  return false;
}

// With y = (x, u) the stage is u = base_u + z a(t, x, u), x = base_x + z u.
bool StageSolver::own_method(double t, const double* base, double z, double* y) {
  if (!second_order()) return false;
  const size_t n = eq_.size() / 2;
  const double tolerance = eq_.advance().newton_tolerance;
  if (!second_order()->solve_stage({t, z, z, base, base + n, tolerance}, y + n)) return false;
  for (size_t i = 0; i < n; ++i) y[i] = base[i] + z * y[n + i];
  return true;
}

}  // namespace truestep
