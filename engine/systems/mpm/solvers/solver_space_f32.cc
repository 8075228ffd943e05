// The solver in space with f32, for both kinds of splines.
#include "engine/systems/mpm/solvers/make_solver.h"
#include "engine/systems/mpm/solvers/solver_of.h"

namespace truestep::mpm {

template <>
std::unique_ptr<const Solver> make_solver_of<3, float>(const Setting& s) {
  return solver_with_splines<3, float>(s);
}

}  // namespace truestep::mpm
