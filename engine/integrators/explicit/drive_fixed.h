// The loop of a fixed-step method over [t, t_end] in `fixed_steps` equal steps. `Method` has the members of
// AdaptiveMethod (drive.h) except first_step and attempt, and bool step(t, h): false if an implicit step's
// equations have no solution within reach of Newton's method.
#pragma once
#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/integrators/explicit/drive.h"

namespace truestep {

/// Throws Instability when the step's equations cannot be solved, or their solution is not finite.
template <class Method>
void drive_fixed(Advance& in, Method& method) {
  method.begin(in.t);
  const double h = (in.t_end - in.t) / double(in.fixed_steps);
  for (uint64_t k = 0; k < in.fixed_steps; ++k) {
    const double t = in.t + double(k) * h;
    double t1 = k + 1 == in.fixed_steps ? in.t_end : in.t + double(k + 1) * h;
    if (!method.step(t, h)) {
      const double* y = method.solution();
      const double* candidate = method.candidate();
      for (size_t i = 0; i < in.f.size(); ++i) {
        if (!std::isfinite(y[i])) step_control::give_up(in, t, h, y, candidate, 0);
      }
      throw Instability("", "y", method.worst(h),
                        "Newton's method found no solution of the step at t = " + short_number(t) +
                            " s with a step of " + short_number(h, 3) + " s");
    }
    if (in.statistics) ++in.statistics->steps;
    auto verdict = StepWatcher::Verdict::go_on;
    if (in.watcher) verdict = in.watcher->accepted(t, t1, method.candidate(), method.between(t, h));
    if (verdict == StepWatcher::Verdict::stop || k + 1 == in.fixed_steps) {
      std::copy_n(method.candidate(), in.f.size(), in.y);
      in.reached = t1;
      return;
    }
    method.accept(t1);
  }
}

}  // namespace truestep
