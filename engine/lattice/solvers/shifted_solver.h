// (shift I - step L) x = b on a lattice, L = div(c grad .): the linear systems of implicit methods for heat
// (shift 1, step z) and waves (shift 1 + z k, step z^2).
#pragma once
#include "engine/lattice/forcing.h"
#include "engine/math/complex.h"

namespace truestep::lattice {

class ShiftedSolver {
 public:
  virtual ~ShiftedSolver() = default;
  /// False if the matrix is singular or not finite.
  virtual bool factor(double shift, double step) = 0;
  virtual bool factor(Complex shift, Complex step) = 0;
  /// In place; x = b at Dirichlet nodes.
  virtual void solve(double* b, const ThreadArena& arena) = 0;
  virtual void solve(double* re, double* im, const ThreadArena& arena) = 0;
};

/// By discrete transforms if the coefficient is constant and no side is a Robin side, otherwise by conjugate
/// gradients with a multigrid cycle; null if the operator has order 4 and neither applies.
std::unique_ptr<ShiftedSolver> make_shifted_solver(const LatticeModel& model, const Constants& constants,
                                                   double t, const Diffusion& diffusion);

}  // namespace truestep::lattice
