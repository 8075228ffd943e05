#include "engine/systems/mpm/solver.h"

#include "engine/systems/mpm/solvers/make_solver.h"

namespace truestep::mpm {

namespace {

template <class T>
std::unique_ptr<const Solver> of_dimension(const Setting& s) {
  return s.def.dimension == 2 ? make_solver_of<2, T>(s) : make_solver_of<3, T>(s);
}

}  // namespace

std::unique_ptr<const Solver> make_solver(const Setting& s) {
  return s.def.precision == Precision::f32 ? of_dimension<float>(s) : of_dimension<double>(s);
}

}  // namespace truestep::mpm
