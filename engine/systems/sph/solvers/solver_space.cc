// The solver in space, for both precisions.
#include "engine/systems/sph/solvers/make_solver.h"
#include "engine/systems/sph/solvers/solver_of.h"

namespace truestep::sph {

std::unique_ptr<const Solver> make_space_solver(const Setting& s) {
  if (s.def.precision == Precision::f32) return std::make_unique<SolverOf<3, float>>(s);
  return std::make_unique<SolverOf<3, double>>(s);
}

}  // namespace truestep::sph
