// Steps with nearly rigid forces where shifts of their lengths do not converge (stage_newton_soft.cc):
// springs from every point to the next but one make a straight rope a flat one at each of its points. Here
// the tensions T are unknowns beside the velocities,
//   M (u - u0) = g f(x, T),   T = k (l(x) - L),
// and Newton's method is applied to both. With T eliminated it is Newton's method with the forces at x, but
// with the sideways stiffness T / l of the tensions that the last correction predicted, k (l + n . dx - L),
// instead of those at x: a link that turns by an angle a is longer by L a^2 / 2 until the next correction, a
// tension k L a^2 / 2 that has nothing to do with the solution's. Full steps: neither the residual nor the
// potential tells whether one that turns links is good.
#include <algorithm>
#include <cmath>

#include "engine/base/interrupt.h"
#include "engine/integrators/implicit/newton/stage_newton.h"

namespace truestep {

namespace {

constexpr int kMostCorrections = 60;
/// Multiple of the forces' rounding at which a residual is solved, if its correction changes velocities or
/// positions by no more than the following fractions.
constexpr double kRounded = 8;
constexpr double kTensionSettled = 1e-6, kTensionStill = 1e-12;
constexpr double kMostTurn = 0.3;  ///< rad, by which a correction may turn a link

}  // namespace

// The correction d at u, of the matrix with as little of the definite one as makes it definite.
void StageNewton::solve_under_tensions(const StageEquation& eq, std::span<const double> u) {
  for (double share = 0;; share = share > 0 ? std::min(1.0, 2 * share) : 0.25) {
    if (share == 0.25) system_.differentiate(eq.t, x_, u, Derivatives::both, rate_position());
    system_.assemble(eq.g, eq.s, share);
    system_.constrain();
    const auto sign = system_.solve(b_, d_, 1e-14);
    ++report_.solves;
    if (sign == BlockSolver::Result::Sign::positive || share >= 1) return;
  }
}

// From u and the tensions that are held.
StageNewton::Failure StageNewton::follow_tensions(const StageEquation& eq, std::span<double> u) {
  Evaluation e{m_.input.workspace, m_.input.arena};
  const auto momentum = [&](std::span<const double> of) {
    return std::sqrt(system_.sum_free([&](size_t k, double w) { return of[k] * of[k] / w; }));
  };
  norm_ = evaluate(eq, u);
  for (int it = 0; it < kMostCorrections; ++it) {
    interruption_point();
    record();
    if (!std::isfinite(norm_)) return "met non-finite forces";
    if (lag_ == Lag::iterate) std::copy(x_.begin(), x_.end(), lagged_.begin());
    system_.differentiate(eq.t, x_, u, Derivatives::exact, rate_position());
    report_.floor = system_.rounding_floor(x_, u, eq.g);
    report_.target = options_.newton_tolerance * std::max(momentum(eq.u0), momentum(u));
    const bool solved = norm_ <= std::max(report_.target, kRounded * report_.floor);
    solve_under_tensions(eq, u);
    const double part = softening_->predict_tensions({eq.t, x_, u, m_.state}, d_, eq.s, kMostTurn, e);
    double change = 0, size = 0, places = 0;
    for (size_t k = 0; k < n_; ++k) change += d_[k] * d_[k], size += u[k] * u[k], places += x_[k] * x_[k];
    m_.loop(n_, [to = u.data(), d = d_.data(), part](size_t i) { to[i] += part * d[i]; });
    norm_ = evaluate(eq, u);
    ++report_.iterations;
    const bool settled = change <= kTensionSettled * kTensionSettled * size ||
                         eq.s * eq.s * change <= kTensionStill * kTensionStill * places;
    if (solved && settled) return nullptr;
  }
  return "did not converge";
}

}  // namespace truestep
