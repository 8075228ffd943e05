// Solves the stage equations of most implicit methods,
//   Y = base + z f(t, Y),
// by simplified Newton iterations with (I - z J)^-1. The Jacobian is that of a step's start or an earlier
// one; it is recomputed when iterations contract slowly or fail. The factors are kept as long as z and J are.
// If a fixed step still fails, the full Newton method follows: a Jacobian at every iterate, and increments
// shortened until the next one promises to be smaller (natural monotonicity, Deuflhard 2004, section 3.3),
// and then the equations' own method, if they have one.
#pragma once
#include "engine/integrators/implicit/newton/newton_iteration.h"

namespace truestep {

class StageSolver {
 public:
  using Scale = IncrementScale<Equations>;
  StageSolver(Equations& eq, Scale::By by);

  /// Before a step from (t, y) with rate f(t, y); false: no factors. May be repeated with another z.
  bool prepare(double t, const double* y, const double* rate, double z);
  /// y: a guess, then the solution; d: scratch. False: no convergence.
  bool solve(double t, const double* base, double z, double* y, double* d);
  /// After a failure: true when the same step deserves another try, with a new Jacobian or more.
  bool try_again();
  /// After an accepted step: the Jacobian is now old, and bad if iterations were slow.
  void step_accepted();

 private:
  bool newton(double t, const double* base, double z, double* y, double* d);
  bool own_method(double t, const double* base, double z, double* y);
  const SecondOrder* second_order() const { return eq_.f().second_order(); }

  Equations& eq_;
  Scale scale_;
  bool linearised_ = false, fresh_ = false, whole_ = false;
  double factored_ = 0, slowest_ = 0;
};

}  // namespace truestep
