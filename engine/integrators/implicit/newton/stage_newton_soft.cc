// Steps with nearly rigid forces, solved with softer ones and shifted lengths
// (core/equations/softening_forces.h).
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/integrators/implicit/newton/stage_newton.h"

namespace truestep {

namespace {

/// (omega h)^2 up to which Newton's method converges by itself; that of softened forces; and how well their
/// first solution must be solved.
constexpr double kStiffest = 1e7, kSofter = 3e6, kApproach = 1e-6;
constexpr int kMostShifts = 30, kMostIterations = 25;  ///< the latter of one shift
/// Shifts that leave more than this fraction of the error are too slow, and forces become stiffer for the
/// next: up to the (omega h)^2 at which rounding of the matrix is still invisible, or to the share with which
/// a flat rope under its load, where a share s leaves (1 - s) / (1 + 2 s) of the error, needs some twenty
/// shifts.
constexpr double kSlow = 0.25, kStiffer = 4, kStillAccurate = 1e9, kStiffestShare = 0.25;

/// Softens the forces while it lives.
class Softened {
 public:
  Softened(const SofteningForces& forces, Motion& m, double share)
      : forces_(forces), state_(m.state), e_{m.input.workspace, m.input.arena} {
    forces_.soften(state_, share, e_);
  }
  ~Softened() { forces_.restore(state_, e_); }
  Softened(const Softened&) = delete;
  Softened& operator=(const Softened&) = delete;

 private:
  const SofteningForces& forces_;
  State& state_;
  Evaluation e_;
};

/// Releases tensions, if any were held, when it ends.
class TensionsReleased {
 public:
  TensionsReleased(const SofteningForces& forces, Evaluation& e) : forces_(forces), e_(e) {}
  ~TensionsReleased() { forces_.release_tensions(e_); }
  TensionsReleased(const TensionsReleased&) = delete;
  TensionsReleased& operator=(const TensionsReleased&) = delete;

 private:
  const SofteningForces& forces_;
  Evaluation& e_;
};

}  // namespace

// Fraction of their stiffness that the forces may keep.
double StageNewton::softer(const StageEquation& eq) const {
  if (!softening_) return 1;
  const double stiff = softening_->fastest_squared(m_.state) * eq.g * eq.s;
  return stiff > kStiffest ? kSofter / stiff : 1;
}

// Nearly rigid links form a valley whose floor bends away from every direction within a fraction 1 / (omega
// h) of a link's length, and forces whose rounding exceeds their change. Softer forces widen it enough to
// follow, and a few shifts of their lengths lead to the solution of the full ones.
StageNewton::Failure StageNewton::approach(double share, const StageEquation& eq, std::span<double> u) {
  Evaluation e{m_.input.workspace, m_.input.arena};
  const TensionsReleased at_the_end(*softening_, e);
  std::copy(u.begin(), u.end(), guess_.begin());
  Failure failure;
  {
    const Softened softened(*softening_, m_, share);
    failure = find(kApproach, eq, u);
    report_.softened = report_.iterations;
    if (report_.held) {
      lag_ = Lag::held;
      std::copy(eq.x0.begin(), eq.x0.end(), lagged_.begin());
    }
    if (failure) {
      // From the guess, with the tensions at the start.
      std::copy(guess_.begin(), guess_.end(), u.begin());
      keep_on_surfaces(u);
      softening_->hold_tensions({eq.t, eq.x0, u, m_.state}, e);
    } else if ((failure = stiffen(share, report_.target * (options_.newton_tolerance / kApproach), eq, u))) {
      // From where softer forces were solved last, with their tensions.
      std::copy(start_.begin(), start_.end(), u.begin());
      move(eq, u);
      softening_->hold_tensions({eq.t, x_, u, m_.state}, e);
    }
  }
  if (failure) failure = follow_tensions(eq, u);
  lag_ = Lag::iterate;
  return failure;
}

// Every shift removes most of the length error: for ropes of n links all but a fraction of about n^2 / (omega
// h)^2. It ends when the shifted equations are solved as they are.
StageNewton::Failure StageNewton::stiffen(double share, double target, const StageEquation& eq,
                                          std::span<double> u) {
  constexpr double kRoundings = 8 * std::numeric_limits<double>::epsilon(), kStretch = 1e-6;
  constexpr double kHidden = 8, kSettled = 0.2;  // multiples of the expected rounding
  const double accurate = std::min(1.0, share * (kStillAccurate / kSofter));
  double stiffest = std::max(kStiffestShare, accurate);
  Evaluation e{m_.input.workspace, m_.input.arena};
  double reach = 0;
  for (const double c : x_) reach = std::max(reach, std::abs(c));
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kMostShifts; ++k) {
    const double used = share;
    const auto lengths = softening_->shift({eq.t, x_, u, m_.state}, m_.state, share, e);
    if (lengths.off <= kRoundings * reach + kStretch * lengths.stretched) return nullptr;
    // Nearly flat sheets have tensions that grow without bound: shifts alone do not converge.
    if (lengths.off > kSlow * last && share < stiffest) share = std::min(kStiffer * share, stiffest);
    last = lengths.off;
    norm_ = evaluate(eq, u);
    report_.target = std::max(target, kHidden * report_.floor);
    if (norm_ <= std::max(target, kSettled * report_.floor)) return nullptr;
    if (norm_ > report_.target) {
      first_ = std::numeric_limits<double>::infinity();
      std::copy(u.begin(), u.end(), start_.begin());
      if (const Failure failure = iterate_to(report_.target, kMostIterations, eq, u)) {
        if (used <= accurate) return failure;
        // Too stiff for these equations, which keep their tensions where they were solved last.
        std::copy(start_.begin(), start_.end(), u.begin());
        norm_ = evaluate(eq, u);
        share = stiffest = accurate;
        --k;
      }
    } else {
      full_step_unasked(eq, u);
    }
  }
  return norm_ <= report_.target ? nullptr : "did not converge";
}

// Rounding hides whether the step is better, but it removes what the lengths still lack.
void StageNewton::full_step_unasked(const StageEquation& eq, std::span<double> u) {
  system_.differentiate(eq.t, x_, u, Derivatives::exact, rate_position());
  system_.assemble(eq.g, eq.s);
  system_.constrain();
  system_.solve(b_, d_, 1e-6);
  m_.loop(n_, [to = u.data(), d = d_.data()](size_t i) { to[i] += d[i]; });
  norm_ = evaluate(eq, u);
  ++report_.solves, ++report_.iterations;
  record();
}

}  // namespace truestep
