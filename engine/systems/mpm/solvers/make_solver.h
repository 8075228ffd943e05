// Solvers of each dimension and precision, each compiled apart.
#pragma once
#include <memory>

#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

template <int D, class T>
std::unique_ptr<const Solver> make_solver_of(const Setting& s);

template <>
std::unique_ptr<const Solver> make_solver_of<2, float>(const Setting& s);
template <>
std::unique_ptr<const Solver> make_solver_of<2, double>(const Setting& s);
template <>
std::unique_ptr<const Solver> make_solver_of<3, float>(const Setting& s);
template <>
std::unique_ptr<const Solver> make_solver_of<3, double>(const Setting& s);

}  // namespace truestep::mpm
