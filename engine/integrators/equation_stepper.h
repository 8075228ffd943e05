// A right-hand side and a row of the table make a step: what systems that are y' = f(t, y) and nothing else
// share. The columns of the state that a method needs, one meaning of the tolerance (error per unknown at
// most absolute + relative |y|; `tolerance` stands for both where they are not given), messages in the
// system's own words, and what the method has counted.
#pragma once
#include <string>

#include "engine/core/build.h"
#include "engine/core/observables.h"
#include "engine/core/system.h"
#include "engine/integrators/advance.h"

namespace truestep {

/// Fastest motions of the equations: angular frequency and decay rate, 1/s.
struct Rates {
  double omega = 0, damping = 0;
};

class EquationStepper {
 public:
  /// What is used where the scene names no method.
  struct Defaults {
    std::string_view usual;      ///< explicit, while the scene's step is inside its interval
    std::string_view divides;    ///< adaptive, for steps up to `most_divisions` times beyond it
    double most_divisions = 50;  ///< of the interval of `usual`
    std::string_view stiff;      ///< implicit, for everything beyond
  };
  /// Error "scene_invalid" with pointer "/integrator" and the methods that would do when the named one is
  /// unknown or cannot serve f.
  EquationStepper(const IntegratorChoice& choice, const Defaults& defaults, const RightHandSide& f,
                  const Rates& rates, double dt);

  const Integrator& method() const { return *method_; }
  const IntegratorOptions& options() const { return options_; }
  const Tolerance& tolerance() const { return tolerance_; }
  /// Why this method, for the plan.
  const std::string& why() const { return why_; }
  /// Largest step of a method of fixed step for these rates; nothing: no limit or none known.
  std::optional<double> stable_dt(const Rates& rates) const;

  /// Adds the columns "integrator.carry", "integrator.work" and "integrator.memory" for n unknowns.
  void add_columns(State& state, size_t n) const;
  /// Advances y by input.h; the columns are those of `state`. `surroundings` names everything besides t and y
  /// that f depends on (Advance).
  void step(const RightHandSide& f, double* y, State& state, const StepInput& input,
            uint64_t surroundings = 0) const;
  /// s, where the step of this input ends.
  static double end_of(const StepInput& input);
  /// Adds to the counters that `observe` shows.
  static void count(State& state, const Statistics& statistics);
  /// What is remembered of earlier steps belongs to other equations: begins afresh.
  static void forget(State& state);
  /// integrator.steps, .rejected, .rates, .jacobians.
  static void observe(const State& state, Observables& out);

 private:
  const Integrator* method_;
  IntegratorOptions options_;
  Tolerance tolerance_;
  std::string why_;
};

}  // namespace truestep
