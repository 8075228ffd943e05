#include "engine/systems/mpm/make_solver.h"
#include "engine/systems/mpm/solver_of.h"

namespace truestep::mpm {

template <>
std::unique_ptr<const Solver> make_solver_of<3, float>(const Setting& s) {
  return solver_with_splines<3, float>(s);
}

}  // namespace truestep::mpm
