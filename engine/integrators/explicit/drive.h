// The loop of an adaptive method over [t, t_end]: attempt, judge, accept or retry with a shorter step. Time
// is a sum of two doubles, so that 1e5 steps lose no digit of it.
#pragma once
#include "engine/integrators/control/step_control.h"

namespace truestep {

class AdaptiveMethod : public Interpolant {
 public:
  /// Evaluates what the first step needs.
  virtual void begin(double t) = 0;
  /// A length when nothing is known.
  virtual double first_step() = 0;
  /// Leaves a candidate, returns the squared error (1 = tolerance).
  virtual double attempt(double t, double h) = 0;
  /// The candidate becomes the solution.
  virtual void accept(double t1) = 0;
  /// As long as the right-hand side.
  virtual double* candidate() = 0;
  virtual const double* solution() const = 0;
  /// From the present solution to the candidate.
  virtual const Interpolant& between(double t, double h) = 0;
  /// The component whose error is largest.
  virtual long long worst(double h) const = 0;
};

/// `Method` is AdaptiveMethod, whose loop is compiled once (drive.cc), or has the same members without their
/// being virtual: the compiler then makes one function of the method and this loop, 3 to 10 % less time for
/// the small problems of tests/bench/work_precision.py.
template <class Method>
void drive(Advance& in, Method& method, const step_control::Law& law) {
  step_control::Controller controller(law, in.carry.last_error);
  method.begin(in.t);
  double h = in.carry.step > 0 ? in.carry.step : method.first_step();
  double t = in.t, t_low = 0;
  uint64_t steps = 0, rejected = 0;
  for (;;) {
    const double left = (in.t_end - t) - t_low;
    const bool last = h >= left * (1 - 1e-12);
    // Less than two steps left: two equal ones, so that no sliver remains.
    const double now = last ? left : 2 * h > left ? 0.5 * left : h;
    if (steps + rejected >= in.max_steps) step_control::too_many_steps(in, t, h, method.worst(now));
    const double error = method.attempt(t, now);
    if (!(error <= 1)) {
      h = now * controller.rejected(error);
      ++rejected;
      if (h <= step_control::smallest_step(in, t)) {
        step_control::give_up(in, t, h, method.solution(), method.candidate(), method.worst(now));
      }
      continue;
    }
    ++steps;
    const double factor = controller.accepted(error, now);
    h = now < h ? std::max(h, now * factor) : now * factor;
    const double forward = now + t_low, sum = t + forward, part = sum - t;
    t_low = (t - (sum - part)) + (forward - part);
    double t1 = last ? in.t_end : sum;
    auto verdict = StepWatcher::Verdict::go_on;
    if (in.watcher) verdict = in.watcher->accepted(t, t1, method.candidate(), method.between(t, now));
    const bool stop = verdict == StepWatcher::Verdict::stop;
    t = t1;
    if (last || stop) {
      std::copy_n(method.candidate(), in.f.size(), in.y);
      break;
    }
    method.accept(t1);
  }
  in.reached = t;
  in.carry.step = h;
  in.carry.last_error = controller.last_error();
  if (in.statistics) in.statistics->steps += steps, in.statistics->rejected += rejected;
}
extern template void drive(Advance& in, AdaptiveMethod& method, const step_control::Law& law);

}  // namespace truestep
