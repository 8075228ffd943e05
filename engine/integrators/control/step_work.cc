#include "engine/integrators/control/step_work.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/newton/newton_matrix.h"

namespace truestep {

namespace {

/// Work per internal step if no trial is made: for fixed steps as counted on falling nets of 10 x 10 to 40 x
/// 40 points, where Newton's method needs several parts for half of the steps; for the others on
/// reaction-diffusion on a grid of 20 x 20 points at a tolerance of 1e-6, with the number of internal steps
/// relative to a second-order method.
struct Habits {
  std::string_view method;
  double rates, jacobians, factorisations, solves, steps = 1;
};
constexpr Habits kHabits[] = {
    {"implicit_midpoint", 13, 2, 2, 12},
    {"trapezoid", 13, 2, 2, 12},
    {"bdf2", 13, 2, 2, 12},
    {"newmark", 13, 2, 2, 12},
    {"generalized_alpha", 13, 2, 2, 12},
    {"tr_bdf2", 6, 0.2, 1, 6.5},
    {"sdirk4", 10.7, 0.2, 0.6, 11.5, 0.5},
    {"rodas5p", 8.7, 1, 1, 8, 0.25},
    {"radau5", 6.5, 0.2, 0.6, 3, 0.45},
    {"cvode_bdf", 2, 0.1, 0.2, 1.6, 1},
};

/// ns per multiplication of an LU factorisation and of a solve: loops over a band and over blocks are
/// vectorised, those over the pattern of an LU are not.
struct Pace {
  double factor, solve;
};
Pace pace(const NewtonMatrix& matrix) {
  switch (matrix.kind()) {
    case NewtonMatrix::Kind::dense:
      return {0.3, 0.6};
    case NewtonMatrix::Kind::band:
      return {0.13, 0.5};
    case NewtonMatrix::Kind::sparse:
      // By blocks and half of them: nets of 40 x 40 points.
      return matrix.symmetric() ? Pace{0.09, 0.6} : Pace{1.4, 2};
    case NewtonMatrix::Kind::own:
      break;
  }
  return {0.2, 0.5};
}

/// Internal steps of an adaptive method: as many as the first step's length suggests, but no more than it
/// takes to grow from that to the whole step by a factor per step.
double internal_steps(const RightHandSide& f, double h, const double* y, const Tolerance& tolerance) {
  const size_t n = f.size();
  std::vector<double> rate(n);
  f.rate(0, y, rate.data());
  // Length over which the solution changes by the cube root of the tolerance: a typical step of a
  // second-order method.
  double fastest = 0;
  for (size_t i = 0; i < n; ++i) {
    const double size = std::max(std::abs(y[i]), tolerance.absolute / std::max(tolerance.relative, 1e-12));
    if (size > 0) fastest = std::max(fastest, std::abs(rate[i]) / size);
  }
  const double liked = 0.1 / std::max(fastest, 1e-300);
  const double ratio = h / liked;
  return ratio <= 1 ? 1 : std::min(ratio, 3 + 4 * std::log10(ratio));
}

/// Work of later steps relative to the first kSettled ones, in which little moves yet: nets, ropes and beams.
constexpr double kLater = 1.6, kSettled = 20;
/// Longest estimated time of a trial, and the fewest internal steps that are informative.
constexpr double kTrialSeconds = 0.15, kFewest = 2;
/// Internal steps in a step of a scene whose internal steps are too long to try: nets of 60 x 60 and 100 x
/// 100 points that begin at rest take 15 to 30 of tr_bdf2 once they move, smooth problems a few.
constexpr double kUntried = 10;

/// Ends a run after some internal steps.
class Stop final : public StepWatcher {
 public:
  explicit Stop(size_t steps) : steps_(steps) {}
  Verdict accepted(double, double& t1, double*, const Interpolant&) override {
    if (++taken == (steps_ + 1) / 2) middle = t1;
    return taken < steps_ ? Verdict::go_on : Verdict::stop;
  }

  size_t taken = 0;
  double middle = 0;  ///< s, the time after half of the steps

 private:
  size_t steps_;
};

/// How far a method gets in its first internal steps, in steps of the scene, at the pace of the later half of
/// them and in all, and their work.
struct Trial {
  double done = 0, reached = 0;
  Statistics count;
};
/// Steps of the scene that a trial takes at most.
constexpr int kMostSteps = 30;
std::optional<Trial> try_steps(const Integrator& method, const RightHandSide& f, double h, const double* y,
                               const Tolerance& tolerance, size_t steps) {
  std::vector<double> at(y, y + f.size());
  Workspace workspace;
  Carry carry;
  Stop stop(steps);
  Trial out;
  // A method that continues over the session's steps takes internal steps of any length; others end with
  // every step and go on with what they have learnt.
  const bool over = method.name.starts_with("cvode");
  double reached = 0;
  for (int k = 0; k < (over ? 1 : kMostSteps) && stop.taken < steps; ++k) {
    Advance run{.f = f,
                .t = k * h,
                .t_end = over ? kMostSteps * h : (k + 1) * h,
                .y = at.data(),
                .workspace = workspace,
                .carry = carry};
    run.tolerance = tolerance, run.watcher = &stop, run.statistics = &out.count;
    run.max_steps = 4 * steps;
    try {
      method.advance(run);
    } catch (const Instability&) {
      return std::nullopt;
    }
    reached = run.reached;
    carry.step = std::min(carry.step, h);
  }
  out.done = out.reached = reached / h;
  // The first half begins at rest, and with minute steps of order 1, which later steps do not repeat.
  if (stop.middle > 0 && reached > stop.middle) {
    const auto half = (steps + 1) / 2;
    const double share = 1 - static_cast<double>(half) / static_cast<double>(stop.taken);
    out.done = (reached - stop.middle) / (share * h);
  }
  return out.done > 0 ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<StepWork> implicit_step_work(const Integrator& method, const RightHandSide& f, double rate,
                                           double h, const double* y, const Tolerance& tolerance) {
  const auto* habits = std::find_if(std::begin(kHabits), std::end(kHabits),
                                    [&](const Habits& k) { return k.method == method.name; });
  if (habits == std::end(kHabits) || f.size() == 0) return std::nullopt;
  NewtonMatrix matrix;
  matrix.bind(f);
  const double steps = method.stepping == Integrator::Stepping::adaptive
                           ? std::max(1.0, habits->steps * internal_steps(f, h, y, tolerance))
                           : 1;
  StepWork w;
  w.rates = steps * habits->rates, w.jacobians = steps * habits->jacobians;
  w.factorisations = steps * habits->factorisations, w.solves = steps * habits->solves;
  w.rate = rate + static_cast<double>(f.size());
  w.jacobian = matrix.jacobian_work(rate);
  const FactorWork each = matrix.factor_work();
  const Pace ns = pace(matrix);
  // radau5 factorises and solves one real and one complex matrix, counted one by one: the mean of both.
  const double complex = method.name == "radau5" ? 2.5 : 1;
  w.factorisation = complex * ns.factor * each.factor, w.solve = complex * ns.solve * each.solve;
  // The number of internal steps depends on the solution.
  if (method.stepping != Integrator::Stepping::adaptive) return w;
  const double most = kTrialSeconds / std::max(w.seconds() / steps, 1e-6);
  if (most < kFewest) {
    const double more = std::max(1.0, kUntried / steps);
    for (double* n : {&w.rates, &w.jacobians, &w.factorisations, &w.solves}) *n *= more;
    return w;
  }
  if (const auto trial = try_steps(method, f, h, y, tolerance, static_cast<size_t>(most))) {
    const double later = trial->reached < kSettled ? kLater : 1;
    const auto whole = [&](uint64_t n) { return later * static_cast<double>(n) / trial->done; };
    w.rates = whole(trial->count.rates), w.jacobians = whole(trial->count.jacobians);
    w.factorisations = whole(trial->count.factorisations), w.solves = whole(trial->count.solves);
  }
  return w;
}

}  // namespace truestep
