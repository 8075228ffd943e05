// Waves in a box:
//   u_tt = div(c^2 grad u) - k u_t + s,   c speed, k damping, s acceleration,
// on nodes (lattice/lattice.h) with Dirichlet, Neumann, Robin or periodic sides, by any method of the table
// for first- or second-order equations. Default: leapfrog while the scene's step is within its stability
// interval (2 over the highest frequency, dx / (c sqrt(d))), the implicit midpoint rule beyond: neither has
// an energy drift. Per unit of density energy is 1/2 integral (u_t^2 + c^2 |grad u|^2). Commands:
// set_parameter speed (where it is a number), damping (where there is some); impulse adds velocity.
#pragma once
#include "engine/core/equations/linear_solver.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/equation_stepper.h"
#include "engine/lattice/lattice_work.h"
#include "engine/systems/wave/wave_def.h"

namespace truestep::wave {

/// u' = v, v' = L u - k v + b(t) for the integrators; y = (u, v).
class WaveEquations final : public RightHandSide, public SecondOrder, public LinearSolver {
 public:
  /// All must outlive this.
  WaveEquations(lattice::LatticeWork& work, const lattice::Lattice& l, double damping,
                const ThreadArena& arena);

  size_t size() const override { return 2 * n_; }
  void rate(double t, const double* y, double* dydt) const override;
  std::string name_of(size_t i) const override {
    return (i < n_ ? "the value at node " : "the rate at node ") + std::to_string(i % n_);
  }
  const SecondOrder* second_order() const override { return this; }

  void acceleration(double t, const double* x, const double* v, double* a) const override;
  bool depends_on_velocity() const override { return damping_ != 0; }
  MatrixShape shape() const override { return work_.matrix().shape(); }
  bool has_jacobian() const override { return true; }
  using RightHandSide::jacobian;
  void jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const override;

  LinearSolver* linear_solver() const override;
  void linearise(double t, const double*) const override { work_.linearise(t); }
  bool factor(double z) override;
  bool factor(Complex z) override;
  void solve(double* b) override;
  void solve(double* re, double* im) override;
  bool factor_second_order(double with_x, double with_v) override;
  void solve_second_order(double* b) override;

 private:
  double damping_of(size_t node) const { return fixed_[node] ? 0 : damping_; }

  lattice::LatticeWork& work_;
  size_t n_;
  double damping_;
  const ThreadArena& arena_;
  std::span<const uint8_t> fixed_;
  std::span<double> product_;
  double z_ = 0;
  Complex complex_z_;
};

/// Columns of the state.
enum Column : State::Column { kValue, kRate, kConstants };

class Wave final : public Tabled<Wave, StagedSystem> {
 public:
  Wave(const WaveDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  void check(StateCheck& check, double) const override { check.finish(); }

  const lattice::LatticeModel& model() const { return model_; }
  const Integrator& method() const { return stepper_->method(); }

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;
  void integrate(State& state, const StepInput& in) const;

  WaveDef def_;
  lattice::LatticeModel model_;
  std::optional<EquationStepper> stepper_;
};

std::unique_ptr<const System> build_wave(const void* def, const BuildContext& context);

}  // namespace truestep::wave
