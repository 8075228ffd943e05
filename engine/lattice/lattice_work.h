// The operator and the forcing of a step on a lattice for the present constants and time, and the solver of
// (shift I - step L) x = b. Lives in the workspace: everything in it follows from the model, the constants
// and the time.
#pragma once
#include <memory>

#include "engine/lattice/forcing.h"
#include "engine/lattice/solvers/shifted_solver.h"

namespace truestep::lattice {

class LatticeWork {
 public:
  /// Must be called first in a step; free of cost while model and constants stay the same.
  void bind(const LatticeModel& model, const Constants& constants, const ThreadArena& arena);
  /// Updates a time-dependent coefficient to t.
  void move_to(double t);
  /// The same for the solver, which stays at t while evaluations move on to other times.
  void linearise(double t);

  const Diffusion& diffusion() const { return diffusion_; }
  /// out = L u + b(t)
  void rate(double t, const double* u, double* out);
  /// u += h (L u + b(t)) in place; false if there is a forcing.
  bool euler_in_place(double t, double h, double* u);
  /// Drift-kick-drift of x'' = L x with t the middle of the step; false if there is a forcing or if several
  /// threads share the rows.
  bool leapfrog_in_place(double t, double h, double* x, double* v);
  /// The two parts of `rate`, for callers that insert something between them.
  void homogeneous(double t, const double* u, double* out);
  void force(double t, double* out);
  /// 1 for nodes with given values.
  std::span<const uint8_t> fixed() const { return fixed_; }
  /// Scratch with one number per node.
  std::span<double> scratch() {
    scratch_.resize(model_->lattice().nodes());
    return scratch_;
  }
  double potential(const double* u) { return diffusion_.potential(u, sums_); }
  double spectral_radius();
  /// The pattern stays in place while the model does not change; methods keep pointers into it.
  const Diffusion::Matrix& matrix();
  /// Solver of (shift I - step L) x = b with the sides of L, x = b at Dirichlet nodes; null if there is none.
  ShiftedSolver* solver();

 private:
  const LatticeModel* model_ = nullptr;
  const ThreadArena* arena_ = nullptr;
  Constants constants_;
  double t_ = 0, solver_time_ = 0;
  Diffusion diffusion_;
  Forcing forcing_;
  std::optional<double> radius_;
  Diffusion::Matrix matrix_;
  bool matrix_stands_ = false;
  std::unique_ptr<ShiftedSolver> solver_;
  std::vector<uint8_t> fixed_;
  std::vector<double> scratch_, waiting_, sums_;
};

}  // namespace truestep::lattice
