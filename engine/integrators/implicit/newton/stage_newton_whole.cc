// Newton steps with the full Jacobian of the residual, whose asymmetric part is missing from the factorised
// matrix (stage_newton.h).
#include <algorithm>
#include <cmath>

#include "engine/integrators/implicit/newton/stage_newton.h"

namespace truestep {

// q = J z for the Jacobian J of the residual at u, by a difference of forces.
void StageNewton::slope_along(const StageEquation& eq, std::span<const double> u, std::span<const double> z,
                              std::span<double> q) {
  const double z2 = system_.sum_free([&](size_t k, double) { return z[k] * z[k]; });
  const double x2 = system_.sum_free([&](size_t k, double) { return x_[k] * x_[k]; });
  // A change of position of 1e-7 of its size: half of the digits.
  const double step = 1e-7 * (std::sqrt(x2) + eq.s) / (eq.s * std::sqrt(z2));
  m_.loop(n_, [&, x0 = x_.data(), s = eq.s](size_t k) {
    trial_[k] = u[k] + step * z[k];
    x_near_[k] = x0[k] + s * step * z[k];
  });
  accelerate(eq.t, x_near_, trial_, a_near_);
  ++report_.evaluations;
  const auto w = system_.inverse_mass();
  for (size_t k = 0; k < n_; ++k) {
    const double wk = w[k / system_.width()];
    q[k] = wk > 0 ? (z[k] - eq.g * (a_near_[k] - a_[k]) / step) / wk : 0;
  }
  if (const auto& on = system_.contacts()) {
    for (size_t i = 0; i < w.size(); ++i) store3(q.data(), i, on->left(i, load3(q.data(), i)));
  }
}

// Fields omit the asymmetric parts of their derivatives (of damping and air by position). Conjugate residuals
// (GCR; Eisenstat, Elman, Schultz 1983) on the full Jacobian, preconditioned with the existing matrix, add
// them: the full step is taken if it halves the residual, otherwise d is unchanged.
bool StageNewton::full_step(const StageEquation& eq, std::span<double> u, double accuracy) {
  const auto r = rest_, d = whole_;
  std::span<double> z[kMostDirections], q[kMostDirections];
  double q2[kMostDirections];
  const auto dot = [&](std::span<const double> p, std::span<const double> q) {
    return system_.sum_free([&](size_t k, double w) { return w * p[k] * q[k]; });
  };
  std::copy(b_.begin(), b_.end(), r.begin());
  std::fill(d.begin(), d.end(), 0);
  const double norm = norm_;
  for (size_t i = 0; i < most_; ++i) {
    z[i] = krylov_.subspan(2 * i * n_, n_), q[i] = krylov_.subspan((2 * i + 1) * n_, n_);
    if (i == 0) {
      std::copy(d_.begin(), d_.end(), z[0].begin());
    } else {
      system_.solve_again(r, z[i], accuracy);
    }
    slope_along(eq, u, z[i], q[i]);
    for (size_t j = 0; j < i; ++j) {
      const double share = dot(q[i], q[j]) / q2[j];
      m_.loop(n_, [&](size_t k) { q[i][k] -= share * q[j][k], z[i][k] -= share * z[j][k]; });
    }
    q2[i] = dot(q[i], q[i]);
    if (!(q2[i] > 0)) break;
    const double share = dot(r, q[i]) / q2[i];
    m_.loop(n_, [&](size_t k) { d[k] += share * z[i][k], r[k] -= share * q[i][k]; });
    if (dot(r, r) <= accuracy * accuracy * norm * norm) break;
  }
  m_.loop(n_, [&](size_t k) { trial_[k] = u[k] + d[k]; });
  norm_ = evaluate(eq, trial_);
  if (norm_ < 0.5 * norm) {
    std::copy(trial_.begin(), trial_.end(), u.begin());
    return true;
  }
  norm_ = evaluate(eq, u);
  return false;
}

}  // namespace truestep
