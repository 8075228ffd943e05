// A force field as first-order equations, y = (x, v) with the rest of the state fixed: how methods that only
// know right-hand sides serve force systems. When dx/dt is v itself, these are second-order equations.
#pragma once
#include "engine/integrators/advance.h"
#include "engine/integrators/linear/field_jacobian.h"
#include "engine/integrators/motion.h"

namespace truestep {

class FieldEquations final : public RightHandSide, public SecondOrder {
 public:
  /// Both must outlive this.
  explicit FieldEquations(Motion& motion) : motion_(motion), plain_(motion.plain_rate()) {}

  size_t size() const override { return motion_.x.size() + motion_.v.size(); }
  void rate(double t, const double* y, double* dydt) const override;
  std::string name_of(size_t i) const override {
    const size_t n = motion_.x.size();
    return i < n ? "element " + std::to_string(i) + " of position"
                 : "element " + std::to_string(i - n) + " of velocity";
  }
  const SecondOrder* second_order() const override { return plain_ ? this : nullptr; }
  /// ForceField::project.
  void project(double* y) const;

  void acceleration(double t, const double* x, const double* v, double* a) const override;
  bool depends_on_velocity() const override {
    return motion_.field.dependence() == Dependence::position_and_velocity;
  }
  /// The field's own, converted to columns when an implicit method first asks.
  bool has_jacobian() const override { return plain_ && motion_.field.has_jacobian(); }
  MatrixShape shape() const override;
  std::span<const double> symmetric_in() const override;
  using RightHandSide::jacobian;
  void jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const override;
  /// The field's, made when an implicit method first asks.
  LinearSolver* linear_solver() const override;
  void linearise(double t, const double* y) const override;
  /// As a minimum of the incremental potential (stage_newton.h), for fields with a Jacobian.
  bool solve_stage(const Stage& stage, double* u) const override;
  void reserve_stage() const override;

 private:
  FieldJacobian& bound_jacobian() const;

  Motion& motion_;
  bool plain_;
};

/// The tolerances given by the options, for forces as for any other equation.
inline Tolerance tolerance_of(const IntegratorOptions& options) {
  return {.relative = options.relative_tolerance.value_or(options.tolerance),
          .absolute = options.absolute_tolerance.value_or(options.tolerance)};
}

/// Watches the internal steps of a force field's adaptive method as long as it is set; y = (x, v). What the
/// watcher stops ends with the state there.
struct FieldWatch {
  StepWatcher* watcher = nullptr;
  double reached = 0;  ///< out: s, where the last run ended
};
/// Of the workspace's FieldWatch.
inline constexpr std::string_view kFieldWatch = "integrator.watch";

/// How a method's history is restored: as numbers in its memory, or by repeating the steps that made it,
/// which requires everything else in the state to be unchanged.
enum class MethodHistory : uint8_t { kept, repeated };

/// Advances a force field's state by one session step with `method`, in as many internal steps as it wants
/// (one, for fixed-step methods). The carry is kept in the columns of prepare_adaptive if they exist.
void step_equations(AdvanceFunction* method, const ForceField& field, State& state, const StepInput& in,
                    const IntegratorOptions& options, MethodHistory history);

/// Makes a step function from an advance function.
template <AdvanceFunction* method, MethodHistory history = MethodHistory::kept>
void step_by(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions& options) {
  step_equations(method, field, state, in, options, history);
}

}  // namespace truestep
