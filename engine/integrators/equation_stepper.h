// Steps a right-hand side with a row of the table: shared by systems that consist of y' = f(t, y) alone.
// Provides the state columns that a method needs, one meaning of the tolerance (error per unknown at most
// absolute + relative |y|; `tolerance` is the default of both), messages in the system's own terms, and the
// method's counters.
#pragma once
#include <string>

#include "engine/core/def/build.h"
#include "engine/core/observables.h"
#include "engine/core/system.h"
#include "engine/integrators/advance.h"

namespace truestep {

/// The fastest motions of the equations: angular frequency and decay rate, 1/s.
struct Rates {
  double omega = 0, damping = 0;
};

class EquationStepper {
 public:
  /// The methods used when the scene names none.
  struct Defaults {
    std::string_view usual;      ///< explicit, while the scene's step is within its stability interval
    std::string_view divides;    ///< adaptive, for steps up to `most_divisions` times larger
    double most_divisions = 50;  ///< relative to the interval of `usual`
    std::string_view stiff;      ///< implicit, for everything beyond
  };
  /// Error "scene_invalid" with pointer "/integrator", listing the suitable methods, when the named one is
  /// unknown or cannot handle f.
  EquationStepper(const IntegratorChoice& choice, const Defaults& defaults, const RightHandSide& f,
                  const Rates& rates, double dt);

  const Integrator& method() const { return *method_; }
  const IntegratorOptions& options() const { return options_; }
  const Tolerance& tolerance() const { return tolerance_; }
  /// The reason for this method, for the plan.
  const std::string& why() const { return why_; }
  /// Largest step of a fixed-step method for these rates; empty: no limit, or none known.
  std::optional<double> stable_dt(const Rates& rates) const;

  /// Adds the columns "integrator.carry", "integrator.work" and "integrator.memory" for n unknowns.
  void add_columns(State& state, size_t n) const;
  /// Advances y by input.h; the columns are those of `state`. `surroundings` identifies everything besides t
  /// and y that f depends on (Advance).
  void step(const RightHandSide& f, double* y, State& state, const StepInput& input,
            uint64_t surroundings = 0) const;
  /// s, the end time of the step with this input.
  static double end_of(const StepInput& input);
  /// Adds to the counters that `observe` shows.
  static void count(State& state, const Statistics& statistics);
  /// The remembered steps belong to other equations: start afresh.
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
