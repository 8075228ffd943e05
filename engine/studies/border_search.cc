#include "engine/studies/border_search.h"

#include <algorithm>
#include <cmath>

#include "engine/studies/trajectory.h"

namespace truestep {

namespace {

constexpr int64_t kFewestSteps = 60;
constexpr double kNear = 4;        // finely from guess / 4 to 4 guess
constexpr double kUsualRuns = 60;  // besides the fine ones
constexpr double kFinest = 0.01, kCoarsest = 0.25;

// Fine steps over a factor of kNear^2, and of kNear beyond the limit.
double fine_runs(double resolution) {
  return 3 * std::log(kNear) / std::log1p(resolution);
}

}  // namespace

BorderSearch::Found BorderSearch::find(double guess, double cpu_limit) {
  const double begin = thread_cpu_seconds();
  trial_.stop_at(begin + cpu_limit);
  Found found{.dt = guess / 256};
  try {
    plan_runs(guess / 256, cpu_limit);
    if (!trial_.stable(guess / 256)) return {guess / 256, Found::Kind::never, trial_.runs(), {}};
    double low = guess / 256;
    // From below in doublings, finely around the guess, then in doublings again.
    while (low < guess / kNear && advance(low, 2 * low, found)) {
    }
    while (!border_ && low < kNear * guess && advance(low, low * (1 + resolution_), found)) {
    }
    while (!border_ && low < 256 * guess && advance(low, 2 * low, found)) {
    }
    found.runs = trial_.runs();
    if (!border_) return found.dt = low, found.kind = Found::Kind::always, found;
    find_again(found);
  } catch (const StabilityTrial::OverBudget&) {
    if (!border_) found.kind = Found::Kind::over_budget;
  } catch (const StabilityTrial::TooLong&) {
    if (!border_) found.kind = Found::Kind::always;
  }
  found.runs = trial_.runs();
  return found;
}

void BorderSearch::plan_runs(double dt, double cpu_limit) {
  constexpr int64_t kProbe = 16;
  const double begin = thread_cpu_seconds();
  trial_.set_steps(kProbe);
  trial_.stable(dt);
  // Every run builds its own world.
  const double rest = thread_cpu_seconds() - begin - trial_.stepping(), each = trial_.stepping() / kProbe;
  const auto affordable = [&] { return (cpu_limit / (kUsualRuns + fine_runs(resolution_)) - rest) / each; };
  resolution_ = kFinest;
  while (resolution_ < kCoarsest &&
         affordable() < static_cast<double>(std::min(params_.steps, 4 * kFewestSteps)))
    resolution_ *= 1.5;
  int64_t steps = params_.steps;
  if (affordable() < static_cast<double>(steps)) {
    steps = std::min(steps, std::max(kFewestSteps, static_cast<int64_t>(affordable())));
  }
  trial_.set_steps(steps);
}

bool BorderSearch::advance(double& low, double next, Found& found) {
  if (trial_.stable(next)) {
    found.dt = low = next;
    return true;
  }
  // There may be more than one limit in between: the lowest is wanted.
  double high = next;
  if (next > low * (1 + 1.5 * resolution_)) {
    double step = low;
    while (step * (1 + resolution_) < next && trial_.stable(step * (1 + resolution_))) {
      found.dt = step *= 1 + resolution_;
    }
    low = step, high = std::min(next, step * (1 + resolution_));
  }
  border_ = high;
  found.dt = bisect(low, high);
  return false;
}

double BorderSearch::bisect(double holds, double fails) {
  while (std::abs(fails - holds) > params_.accuracy * std::min(holds, fails)) {
    const double middle = 0.5 * (holds + fails);
    (trial_.stable(middle) ? holds : fails) = middle;
  }
  return holds;
}

void BorderSearch::find_again(Found& found) {
  bool holds = false;
  const double end = kNear * *border_;
  double last = *border_;
  for (double dt = last * (1 + resolution_); dt < end; last = dt, dt *= 1 + resolution_) {
    const bool now = trial_.stable(dt);
    if (now && holds) found.again.back().to = dt;
    if (now == holds) continue;
    if (now) {
      found.again.push_back({bisect(dt, last), dt});
    } else {
      found.again.back().to = bisect(last, dt);
    }
    holds = now;
  }
}

}  // namespace truestep
