// Linear systems of implicit methods that equations solve by a method of their own, where their structure is
// worth more than any sparsity pattern: trees of links in linear time, although no entry of their Jacobian is
// zero.
#pragma once
#include "engine/core/equations/force_field.h"
#include "engine/math/complex.h"

namespace truestep {

/// Solves (I - z J) x = b with J = df/dy of y' = f(t, y) at the last linearisation point.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// False: singular or not finite.
  virtual bool factor(double z) = 0;
  virtual bool factor(Complex z) = 0;
  /// In place, after a factorisation with a real or a complex z.
  virtual void solve(double* b) = 0;
  virtual void solve(double* re, double* im) = 0;

  /// The same for I - with_v da/dv - with_x da/dx, of half the size, when dx/dt = v.
  virtual bool factor_second_order(double with_x, double with_v) = 0;
  virtual void solve_second_order(double* b) = 0;
};

/// For a force field, y = (x, v).
class FieldLinearSolver : public LinearSolver {
 public:
  virtual void linearise(const Phase& at, Evaluation& e) = 0;
};

}  // namespace truestep
