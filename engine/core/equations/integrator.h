// Time integration methods as table rows (the table: integrators/table/integrators.h). A row promises an
// order, a stability interval and a structure, and tests hold it to each of them.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/core/equations/force_field.h"
#include "engine/core/system.h"

namespace truestep {

struct Advance;  // integrators/advance.h
class RightHandSide;

/// Numerical damping as structural engineers choose it: generalized_alpha's spectral radius at infinity (1:
/// none, 0: the highest modes vanish in one step), and Newmark's two numbers (order 2 for gamma = 1/2 only,
/// unconditionally stable for 2 beta >= gamma >= 1/2).
struct StructuralDamping {
  double spectral_radius = 0.9;
  double newmark_beta = 0.25, newmark_gamma = 0.5;
};

/// A fraction of a second for a small system; a scene can request any number.
inline constexpr int kMaxInternalSteps = 100'000;

/// Settings of methods that have any.
struct IntegratorOptions {
  double tolerance = 1e-6;          ///< adaptive methods: default of the two below
  double newton_tolerance = 1e-10;  ///< implicit methods: relative residual at which Newton stops
  int max_newton_iterations = 200;
  int descent_iterations = 10;  ///< projective_dynamics, vertex_block_descent: per step
  /// Adaptive methods: the error of a step per unknown against absolute + relative |y|.
  std::optional<double> relative_tolerance = {}, absolute_tolerance = {};
  StructuralDamping damping = {};
  int max_internal_steps = kMaxInternalSteps;  ///< adaptive methods: per step, then Instability
};

/// Largest stable omega * h on an undamped oscillator and lambda * h on exponential decay; infinity:
/// unconditional; NaN: no promise (methods that iterate a step until it converges).
struct StabilityInterval {
  double imaginary = 0, real = 0;
  /// s, for these rates in 1/s; infinity: any, NaN: no promise.
  double largest_step(double omega, double damping) const;
};

struct Integrator {
  std::string_view name;   ///< as in a scene
  std::string_view title;  ///< e.g. "classical Runge-Kutta"
  int order = 1;           ///< of the global error
  /// Stability interval with default options; users call `stability_interval`. Adaptive methods: of one
  /// internal step.
  double imaginary_limit = 0, real_limit = 0;
  enum class Structure : uint8_t { none, symplectic } structure = Structure::none;
  enum class Stepping : uint8_t { fixed, adaptive } stepping = Stepping::fixed;
  enum class Kind : uint8_t { explicit_, implicit } kind = Kind::explicit_;
  /// What `advance` requires: any y' = f(t, y), second-order equations, or second-order equations whose
  /// acceleration does not depend on velocity.
  enum class Equations : uint8_t { any, second_order, without_velocity } equations = Equations::any;
  /// Order that remains when the acceleration depends on velocity; 0: the method cannot handle such a field.
  int order_with_velocity = 0;
  std::string_view source;  ///< paper or textbook with equation

  /// Adds the columns that the method carries from step to step (all named "integrator.*"); may be null.
  void (*prepare)(const ForceField&, State&) = nullptr;
  /// Advances position and velocity by input.h.
  void (*step)(const ForceField&, State&, const StepInput&, const IntegratorOptions&) = nullptr;
  /// Doubles that `advance` keeps from call to call (Advance::memory) for n equations; null: none.
  size_t (*memory)(size_t n) = nullptr;
  /// Integrates y' = f(t, y); null: the method needs a force field. A method with `advance` handles both.
  void (*advance)(Advance&) = nullptr;
  /// The method's own reason for refusing a field, if any; may be null. Users call `refusal`.
  std::optional<std::string> (*refuses)(const ForceField&) = nullptr;
  /// The interval if it depends on options; null: it does not.
  StabilityInterval (*interval)(const IntegratorOptions&) = nullptr;
  /// Adds the method's counters as "integrator.*"; may be null.
  void (*observe)(const State&, Observables&) = nullptr;
};

/// Where the method is stable with these options.
StabilityInterval stability_interval(const Integrator& method, const IntegratorOptions& options);
/// Empty when the method can handle the field, otherwise one sentence why not.
std::optional<std::string> refusal(const Integrator& method, const ForceField& field);
/// The same for `advance` on a right-hand side.
std::optional<std::string> refusal(const Integrator& method, const RightHandSide& f);

}  // namespace truestep
