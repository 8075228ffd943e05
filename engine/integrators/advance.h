// One integration of y' = f(t, y) from t to t_end: the input of every method in the table's `advance` column.
// A method adds no state of its own beyond `Carry` and `memory`, so a run restored at t_end repeats every
// choice; its arrays come from the workspace and may vanish between two calls. `memory` belongs to the y that
// the call returned: a method restarts if y has changed since. Adaptive methods accept a step if the weighted
// root mean square of its error estimate is at most 1:
//   sqrt(1/n sum_i (e_i / (absolute + relative * max(|y_i|, |y_i new|)))^2) <= 1
// (Hairer, Norsett, Wanner 1993, eq. II.4.11). They never step over t_end, unless their history is worth more
// (cvode.cc). Fixed-step methods divide [t, t_end] into `fixed_steps` equal steps.
#pragma once
#include <cstdint>
#include <span>

#include "engine/core/equations/integrator.h"
#include "engine/core/equations/right_hand_side.h"
#include "engine/core/state/workspace.h"

namespace truestep {

struct Tolerance {
  double relative = 1e-6;
  double absolute = 1e-6;
  std::span<const double> absolute_each = {};  ///< one per component instead of `absolute`, or empty
};

/// What an adaptive method remembers between calls.
struct Carry {
  double step = 0;        ///< proposal for the next internal step; 0: choose one
  double last_error = 0;  ///< of the last accepted step, 1 = the tolerance; 0: none yet
};

struct Statistics {
  uint64_t steps = 0, rejected = 0;  ///< internal steps accepted, and steps repeated
  uint64_t rates = 0;                ///< evaluations of f (or a)
  uint64_t jacobians = 0, factorisations = 0, solves = 0;

  Statistics& operator+=(const Statistics& o) {
    steps += o.steps, rejected += o.rejected, rates += o.rates;
    jacobians += o.jacobians, factorisations += o.factorisations, solves += o.solves;
    return *this;
  }
  Statistics operator-(const Statistics& o) const {
    return {steps - o.steps,
            rejected - o.rejected,
            rates - o.rates,
            jacobians - o.jacobians,
            factorisations - o.factorisations,
            solves - o.solves};
  }
};

/// The solution between the two ends of an accepted internal step.
class Interpolant {
 public:
  virtual ~Interpolant() = default;
  /// y at t0 + theta (t1 - t0), theta in [0, 1]; order at least 3, see each method.
  virtual void at(double theta, double* y) const = 0;
};

/// Notified of every accepted internal step: dense output, events, running error estimates.
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;
  enum class Verdict : uint8_t { go_on, stop };
  /// y1 is the solution at t1. On stop the run ends there with `reached` = t1; for an event, the watcher may
  /// have moved t1 and y1 back into the step.
  virtual Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) = 0;
};

struct Advance {
  const RightHandSide& f;
  double t = 0, t_end = 0;  ///< s; t_end > t
  double* y = nullptr;      ///< the solution at t, then at `reached`; f.size() values
  Workspace& workspace;
  Carry& carry;
  /// Threads that share loops over many unknowns; null: the calling thread does them alone.
  const ThreadArena* arena = nullptr;
  Tolerance tolerance = {};
  uint64_t fixed_steps = 1;
  uint64_t max_steps = 10'000'000;  ///< accepted + rejected, then Instability
  StructuralDamping damping = {};
  double newton_tolerance = 1e-10;  ///< fixed-step implicit methods: relative change at which Newton stops
  /// What multistep methods keep between calls; NaN at the front when empty. A method that needs a different
  /// length starts anew.
  std::span<double> memory = {};
  /// Identifies everything besides t and y that f depends on, for methods that may have to repeat steps.
  uint64_t surroundings = 0;
  /// Projects a solution onto its manifold (unit quaternions); null: it has none. Methods with a memory call
  /// it on the y that they leave.
  void (*project)(const RightHandSide& f, double* y) = nullptr;
  StepWatcher* watcher = nullptr;
  Statistics* statistics = nullptr;
  double reached = 0;  ///< out: t_end, or where a watcher stopped
};

/// Throws Instability ("the tolerance cannot be met ...", with the index of the first non-finite or otherwise
/// the worst component) when a method cannot continue.
using AdvanceFunction = void(Advance&);

}  // namespace truestep
