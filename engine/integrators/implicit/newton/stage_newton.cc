#include "engine/integrators/implicit/newton/stage_newton.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"

namespace truestep {

namespace {

/// Relative changes by a last correction that are allowed: of u, and of the positions.
constexpr double kSettled = 1e-6, kStill = 1e-12;
constexpr double kNear = 1e-4;  ///< fraction of the first residual: close to a solution
/// Iterations on the whole equations before damping and air are held, and after they were.
constexpr int kDirect = 60, kPolish = 25;
constexpr double kCrawling = 0.25;  ///< fraction of a direction below which a line search makes no progress
constexpr int kLeap = 6;            ///< full steps that may increase the potential before they must have
                                    ///< fallen below the start
/// Multiples of the expected rounding that may hide a residual, and the fraction of the residual above which
/// an iteration was of no help.
constexpr double kHidden = 8, kNoHelp = 0.5;
constexpr double kNoise = 1e-12;  ///< relative error of sums over many terms, generously

}  // namespace

StageNewton::StageNewton(Motion& m, const IntegratorOptions& options)
    : m_(m),
      options_(options),
      n_(m.v.size()),
      system_(m),
      report_(m.input.workspace.object<NewtonReport>(kNewtonReport)),
      lagging_(m.field.lagged_dissipation()),
      softening_(m.field.softening_forces()),
      a_(m.scratch("integrator.k1", n_)),
      b_(m.scratch("integrator.rhs", n_)),
      d_(m.scratch("integrator.dv", n_)),
      x_(m.scratch("integrator.x", n_)),
      lagged_(m.scratch("integrator.x_lagged", n_)),
      trial_(m.scratch("integrator.u", n_)),
      start_(m.scratch("integrator.u_start", n_)),
      leap_(m.scratch("integrator.u_leap", n_)),
      guess_(m.scratch("integrator.u_guess", n_)),
      a_near_(m.scratch("integrator.k2", n_)),
      x_near_(m.scratch("integrator.x_near", n_)),
      rest_(m.scratch("integrator.krylov_r", n_)),
      whole_(m.scratch("integrator.krylov_d", n_)),
      most_(m.field.dependence() == Dependence::position ? 1 : kMostDirections),
      krylov_(m.scratch("integrator.krylov", 2 * most_ * n_)) {
  system_.reserve();
}

const NewtonReport& StageNewton::solve(const StageEquation& eq, std::span<double> u) {
  report_ = {};
  const double share = softer(eq);
  const Failure failure = share < 1 ? approach(share, eq, u) : find(options_.newton_tolerance, eq, u);
  if (failure) {
    fail(std::string("Newton's method ") + failure + " (" + std::to_string(report_.iterations) +
         " iterations)");
  }
  return report_;
}

StageNewton::Failure StageNewton::find(double tolerance, const StageEquation& eq, std::span<double> u) {
  choose_start(eq, u);
  norm_ = first_ = evaluate(eq, u);
  const double momentum =
      std::sqrt(system_.sum_free([&](size_t k, double w) { return eq.u0[k] * eq.u0[k] / w; }));
  report_.target = tolerance * std::max(first_, momentum);
  const bool may_lag = lagging_ && merit_ == Merit::incremental_potential &&
                       m_.field.dependence() == Dependence::position_and_velocity;
  if (may_lag) std::copy(u.begin(), u.end(), start_.begin());
  const int most =
      may_lag ? std::min(kDirect, options_.max_newton_iterations) : options_.max_newton_iterations;
  Failure failure = iterate_to(report_.target, most, eq, u);
  if (failure && may_lag) failure = solve_held(eq, u);
  return failure;
}

// Near the minimum with lagged damping and air, the full equations may have a solution; if not, the minimum
// is taken as the step: as accurate in h, and consistent with the requirement of Kane, Marsden, Ortiz, West
// 2000, "Variational integrators and the Newmark algorithm", section 2.4, that dissipation be convex in the
// velocity.
StageNewton::Failure StageNewton::solve_held(const StageEquation& eq, std::span<double> u) {
  const auto hold = [&](double target) {
    lag_ = Lag::held;
    std::copy(eq.x0.begin(), eq.x0.end(), lagged_.begin());
    norm_ = evaluate(eq, u);
    const Failure failure = iterate_to(target, options_.max_newton_iterations, eq, u);
    lag_ = Lag::iterate;
    return failure;
  };
  std::copy(start_.begin(), start_.end(), u.begin());
  hold(std::max(kNear * first_, report_.target));
  std::copy(u.begin(), u.end(), start_.begin());
  norm_ = evaluate(eq, u);
  if (!iterate_to(report_.target, kPolish, eq, u)) return nullptr;
  std::copy(start_.begin(), start_.end(), u.begin());
  report_.held = true;
  return hold(report_.target);
}

// Computes Newton's correction without applying it, so that a converged iterate keeps its bits: with the
// factors of the last iteration, which are close enough, or with a matrix of its own if there was none.
bool StageNewton::settled(const StageEquation& eq, std::span<const double> u, int iteration) {
  constexpr double kAccurate = 1e-6;
  if (iteration > 0) {
    system_.solve_again(b_, d_, kAccurate);
  } else {
    system_.assemble(eq.g, eq.s, 0);
    system_.constrain();
    system_.solve(b_, d_, kAccurate);
    ++report_.solves;
  }
  double change = 0, size = 0, places = 0;
  for (size_t k = 0; k < n_; ++k) {
    change += d_[k] * d_[k];
    size += u[k] * u[k];
    places += x_[k] * x_[k];
  }
  return change <= kSettled * kSettled * size || eq.s * eq.s * change <= kStill * kStill * places;
}

StageNewton::Failure StageNewton::iterate_to(double target, int most, const StageEquation& eq,
                                             std::span<double> u) {
  double before = 0;
  for (int it = 0;; ++it) {
    interruption_point();
    record();
    if (!std::isfinite(norm_)) return "met non-finite forces";
    if (norm_ <= target) return nullptr;
    system_.differentiate(eq.t, x_, u, Derivatives::exact, rate_position());
    report_.floor = system_.rounding_floor(x_, u, eq.g);
    // Values that have decayed until their squares underflow count as zero: a norm can no longer tell better
    // from worse there.
    constexpr double kNothing = 1e-150;
    // Several roundings may meet: then one more iteration shows that it no longer helps.
    const bool stuck = it > 0 && norm_ > kNoHelp * before && norm_ <= kHidden * report_.floor;
    const bool rounded = stuck || norm_ <= report_.floor + kNothing;
    if (rounded && (eq.end == StageEquation::End::rounding || settled(eq, u, it))) return nullptr;
    before = norm_;
    if (it >= most) return "did not converge";
    // No more accuracy than this iterate deserves.
    const double accuracy =
        std::clamp(std::max(0.1 * report_.target / norm_, 0.1 * norm_ / first_), 1e-14, 1e-2);
    const Search kind = norm_ <= kNear * first_ ? Search::any_solution : Search::descent;
    if (kind == Search::descent && last_share_ < kCrawling && leap(eq, u, accuracy)) {
      ++report_.iterations;
      continue;
    }
    if (!iterate(eq, u, accuracy, kind)) return "found no decrease of the residual";
    ++report_.iterations;
  }
}

// The better of the guess and rest by incremental potential: the solution is lower still, so V never exceeds
// the sum of V and the kinetic energy before.
void StageNewton::choose_start(const StageEquation& eq, std::span<double> u) {
  const auto w = system_.inverse_mass();
  for (size_t k = 0; k < n_; ++k) trial_[k] = w[k / system_.width()] > 0 ? 0 : u[k];
  keep_on_surfaces(u), keep_on_surfaces(trial_);
  move(eq, u);
  std::copy(x_.begin(), x_.end(), lagged_.begin());
  const double guess = value(eq, u);
  if (merit_ == Merit::residual) return;
  move(eq, trial_);
  if (value(eq, trial_) < guess) std::copy(trial_.begin(), trial_.end(), u.begin());
}

// Gives rows on surfaces the velocities prescribed there.
void StageNewton::keep_on_surfaces(std::span<double> u) {
  const auto& on = system_.contacts();
  if (!on) return;
  const auto w = system_.inverse_mass();
  for (size_t i = 0; i < w.size(); ++i) {
    if (w[i] > 0) store3(u.data(), i, on->given(i, load3(u.data(), i)));
  }
}

void StageNewton::move(const StageEquation& eq, std::span<const double> u) {
  m_.loop(n_,
          [x = x_.data(), x0 = eq.x0.data(), u = u.data(), s = eq.s](size_t i) { x[i] = x0[i] + s * u[i]; });
}

void StageNewton::accelerate(double t, std::span<const double> x, std::span<const double> u,
                             std::span<double> a) {
  if (lag_ == Lag::iterate) return m_.acceleration(t, x, u, a);
  Evaluation e{m_.input.workspace, m_.input.arena};
  lagging_->lagged_acceleration({t, x, u, m_.state}, lagged_, a, e);
}

// Where df/du is taken, if not at the iterate.
std::span<const double> StageNewton::rate_position() const {
  return lag_ == Lag::held ? lagged_ : std::span<double>();
}

// Leaves x(u) and -r; returns the norm of r.
double StageNewton::evaluate(const StageEquation& eq, std::span<const double> u) {
  ++report_.evaluations;
  move(eq, u);
  accelerate(eq.t, x_, u, a_);
  const auto w = system_.inverse_mass();
  const size_t width = system_.width();
  const double norm = std::sqrt(system_.sum([&](size_t i) {
    double s = 0;
    for (size_t k = i * width; k < (i + 1) * width; ++k) {
      const double per_mass = eq.g * a_[k] - (u[k] - eq.u0[k]);
      b_[k] = w[i] > 0 ? per_mass / w[i] : 0;
      s += b_[k] * per_mass;
    }
    return s;
  }));
  return system_.contacts() ? residual_on_surfaces() : norm;
}

// The part of -r not supplied by surfaces; returns its norm.
double StageNewton::residual_on_surfaces() {
  const RowContacts& on = *system_.contacts();
  const auto w = system_.inverse_mass();
  return std::sqrt(system_.sum([&](size_t i) {
    if (w[i] == 0) return 0.0;
    Vec3 b = load3(b_.data(), i);
    if (on.kind[i] != RowContacts::kFree) {
      const bool slides = on.kind[i] == RowContacts::kSlides;
      const Vec3 drag = slides ? load3(on.drag.data(), i) : Vec3{};
      const Vec3 left = on.left(i, b + drag);
      store3(on.impulse.data(), i, left - b);
      store3(b_.data(), i, b = left);
    }
    return w[i] * norm2(b);
  }));
}

// phi at u, whose position the last evaluation left.
double StageNewton::value(const StageEquation& eq, std::span<const double> u) {
  Evaluation e{m_.input.workspace, m_.input.arena};
  const auto potential = m_.field.potential({eq.t, x_, u, m_.state}, e);
  const auto dissipation = m_.field.dissipation({eq.t, lagged_, u, m_.state}, e);
  if (!potential || !dissipation) {
    merit_ = Merit::residual;
    return 0;
  }
  const double inertia =
      0.5 * system_.sum_free([&](size_t k, double w) { return (u[k] - eq.u0[k]) * (u[k] - eq.u0[k]) / w; });
  const double v = eq.g / eq.s * *potential;
  double r = eq.g * *dissipation;
  if (const auto& on = system_.contacts()) {
    r -= system_.sum([&](size_t i) {
      const bool slides = on->kind[i] == RowContacts::kSlides;
      return slides ? dot(load3(on->drag.data(), i), load3(u.data(), i)) : 0.0;
    });
  }
  magnitude_ = inertia + std::abs(v) + eq.g / eq.s * m_.field.cancelling_terms(m_.state) + std::abs(r);
  return inertia + v + r;
}

// One iteration. Newton's direction has as little of the definite Jacobian in it as makes the matrix
// definite: with the definite one alone, buckling cloth takes about a hundred iterations, because folds grow
// by a factor of 1.3 in each. Near a solution that is not a minimum (cloth that stays flat by symmetry)
// descent would leave it extremely slowly, so there the exact direction may be taken.
bool StageNewton::iterate(const StageEquation& eq, std::span<double> u, double accuracy, Search kind) {
  constexpr double kFirstShare = 0.25, kSmallShare = 0.1;
  if (lag_ == Lag::iterate) std::copy(x_.begin(), x_.end(), lagged_.begin());
  // Half of what the last iteration needed.
  definite_ = kind == Search::descent && definite_ > kSmallShare ? 0.5 * definite_ : 0;
  bool both = false;
  for (;;) {
    if (definite_ > 0 && !both) {
      system_.differentiate(eq.t, x_, u, Derivatives::both, rate_position());
      both = true;
    }
    system_.assemble(eq.g, eq.s, definite_);
    system_.constrain();
    const auto sign = system_.solve(b_, d_, accuracy);
    ++report_.solves;
    const double slope = -system_.sum_free([&](size_t k, double) { return b_[k] * d_[k]; });
    const bool down = sign == BlockSolver::Result::Sign::positive && slope < 0;
    if (definite_ == 0 && (!down || m_.field.dependence() == Dependence::position_and_velocity)) {
      if ((down || kind == Search::any_solution) && full_step(eq, u, accuracy)) return true;
    }
    if (down || definite_ >= 1) {
      if (definite_ > 0) ++report_.definite;
      return search(eq, u, slope);
    }
    definite_ = std::min(1.0, std::max(kFirstShare, 2 * definite_));
  }
}

// Springs much stiffer than everything else form a valley so narrow and curved that every straight direction
// soon leads up its wall: line searches then follow its bends in tiny steps. Full Newton steps cross it: the
// first leaves the valley, the next return to its floor further down (a watchdog; Chamberlain, Powell,
// Lemarechal, Pedersen 1982). If the potential has not fallen below the start by then, the steps are undone.
bool StageNewton::leap(const StageEquation& eq, std::span<double> u, double accuracy) {
  if (merit_ != Merit::incremental_potential) return false;
  if (lag_ == Lag::iterate) std::copy(x_.begin(), x_.end(), lagged_.begin());
  const double before = value(eq, u), bound = before - kNoise * magnitude_;
  std::copy(u.begin(), u.end(), leap_.begin());
  for (int k = 0; k < kLeap; ++k) {
    if (k > 0) system_.differentiate(eq.t, x_, u, Derivatives::exact, rate_position());
    system_.differentiate(eq.t, x_, u, Derivatives::both, rate_position());
    try {
      for (double share = 0;; share = share > 0 ? std::min(1.0, 2 * share) : 0.25) {
        system_.assemble(eq.g, eq.s, share);
        system_.constrain();
        const auto sign = system_.solve(b_, d_, accuracy);
        ++report_.solves;
        if (sign == BlockSolver::Result::Sign::positive || share >= 1) break;
      }
    } catch (const Instability&) {
      // So far away that the matrix is not finite.
      break;
    }
    m_.loop(n_, [to = u.data(), d = d_.data()](size_t i) { to[i] += d[i]; });
    norm_ = evaluate(eq, u);
    if (!std::isfinite(norm_)) break;
    if (value(eq, u) < bound) return true;
  }
  std::copy(leap_.begin(), leap_.end(), u.begin());
  norm_ = evaluate(eq, u);
  // Continue with the line search.
  last_share_ = 1;
  system_.differentiate(eq.t, x_, u, Derivatives::exact, rate_position());
  return false;
}

// Of phi, whose terms add up to `magnitude`, at the iterate whose derivatives are at hand: of sums over many
// terms, and of lengths from rounded positions, which counts most near rest, where V is small beside it.
double StageNewton::rounding_of_value(const StageEquation& eq, double magnitude) {
  constexpr double kUnits = 2 * std::numeric_limits<double>::epsilon();
  const double lengths = eq.g / eq.s * system_.rounding_energy(x_);
  return kNoise * magnitude + kUnits * std::sqrt(2 * magnitude * lengths) + kUnits * kUnits * lengths;
}

// Moves u along d; false when no step improves it.
bool StageNewton::search(const StageEquation& eq, std::span<double> u, double slope) {
  const bool potential = merit_ == Merit::incremental_potential;
  const double norm = norm_;
  const line_search::Point start{potential ? value(eq, u) : 0, slope};
  const double magnitude = magnitude_;
  std::optional<double> noise;
  const auto go = [&](double share) {
    m_.loop(n_, [to = trial_.data(), u = u.data(), d = d_.data(), share](size_t i) {
      to[i] = u[i] + share * d[i];
    });
    norm_ = evaluate(eq, trial_);
    if (!potential) return line_search::Point{norm_, 0};
    return line_search::Point{value(eq, trial_),
                              -system_.sum_free([&](size_t k, double) { return b_[k] * d_[k]; })};
  };
  double share = 1;
  line_search::Point at = go(share);
  const auto good = [&] {
    if (potential) {
      if (line_search::falls(start, at, share)) return true;
      if (!noise) noise = rounding_of_value(eq, magnitude);
      return line_search::settles(start, at, *noise);
    }
    return norm_ < (1 - line_search::kShare * share) * norm;
  };
  if (good()) {
    while (potential && line_search::goes_on(start, at) && share < line_search::kLongest) {
      const double value_here = at.value;
      at = go(share *= 2);
      if (good() && at.value < value_here) continue;
      at = go(share *= 0.5);
      break;
    }
  } else {
    do {
      share = potential ? line_search::shorter(start, at, share) : 0.5 * share;
      if (share < line_search::kShortest) return false;
      at = go(share);
    } while (!good());
  }
  last_share_ = share;
  std::copy(trial_.begin(), trial_.end(), u.begin());
  return true;
}

void StageNewton::record() {
  report_.last = norm_;
  if (report_.iterations < NewtonReport::kKept) report_.residuals[report_.iterations] = norm_;
}

void StageNewton::fail(const std::string& why) {
  size_t worst = 0;
  for (size_t k = 0; k < n_; ++k) {
    if (!(std::abs(b_[k]) <= std::abs(b_[worst]))) worst = k;
  }
  throw Instability("", "velocity", static_cast<long long>(worst / std::max<size_t>(system_.width(), 1)),
                    why + "; a smaller dt would help");
}

}  // namespace truestep
