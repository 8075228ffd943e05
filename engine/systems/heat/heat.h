// Heat conduction in a box:
//   u_t = div(a grad u) + s,   a diffusivity, s heating,
// on nodes (lattice/lattice.h) with Dirichlet, Neumann, Robin or periodic sides, by any method of the table
// for right-hand sides. Default: rk4 while the scene's step is within its stability interval (2.785 over the
// spectral radius, 4 a d / dx^2), rkc2 up to about a hundred stages, sdirk4 beyond. Commands: set_parameter
// diffusivity (where it is a number); impulse adds heat at a node.
#pragma once
#include "engine/core/equations/linear_solver.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/equation_stepper.h"
#include "engine/lattice/lattice_work.h"
#include "engine/systems/heat/heat_def.h"

namespace truestep::heat {

/// u_t = L u + b(t) for the integrators.
class HeatEquations final : public RightHandSide, public LinearSolver {
 public:
  /// Both must outlive this.
  HeatEquations(lattice::LatticeWork& work, const lattice::Lattice& l, const ThreadArena& arena)
      : work_(work), n_(l.nodes()), arena_(arena) {}

  size_t size() const override { return n_; }
  void rate(double t, const double* y, double* dydt) const override { work_.rate(t, y, dydt); }
  bool euler_in_place(double t, double h, double* y) const override { return work_.euler_in_place(t, h, y); }
  MatrixShape jacobian_shape() const override { return work_.matrix().shape(); }
  bool has_jacobian() const override { return true; }
  void jacobian(double t, const double* y, double* values) const override;
  std::string name_of(size_t i) const override { return "the value at node " + std::to_string(i); }
  std::optional<double> spectral_radius(double t, const double*) const override;

  LinearSolver* linear_solver() const override;
  void linearise(double t, const double*) const override { work_.linearise(t); }
  bool factor(double z) override { return work_.solver()->factor(1, z); }
  bool factor(Complex z) override { return work_.solver()->factor(Complex(1), z); }
  void solve(double* b) override { work_.solver()->solve(b, arena_); }
  void solve(double* re, double* im) override { work_.solver()->solve(re, im, arena_); }
  bool factor_second_order(double, double) override { return false; }
  void solve_second_order(double*) override {}

 private:
  lattice::LatticeWork& work_;
  size_t n_;
  const ThreadArena& arena_;
};

/// Columns of the state.
enum Column : State::Column { kValue, kConstants };

class Heat final : public Tabled<Heat, StagedSystem> {
 public:
  Heat(const HeatDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  /// Half the integral of the squared temperature: not an energy in joules, but conduction alone can only
  /// decrease it.
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  void check(StateCheck& check, double) const override { check.finish(); }

  const lattice::LatticeModel& model() const { return model_; }
  const Integrator& method() const { return stepper_->method(); }

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;
  void integrate(State& state, const StepInput& in) const;

  HeatDef def_;
  lattice::LatticeModel model_;
  std::optional<EquationStepper> stepper_;
};

std::unique_ptr<const System> build_heat(const void* def, const BuildContext& context);

}  // namespace truestep::heat
