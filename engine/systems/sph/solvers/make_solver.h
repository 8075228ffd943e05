// Solvers of each dimension, each compiled apart.
#pragma once
#include <memory>

#include "engine/systems/sph/setting.h"

namespace truestep::sph {

std::unique_ptr<const Solver> make_plane_solver(const Setting& s);
std::unique_ptr<const Solver> make_space_solver(const Setting& s);

}  // namespace truestep::sph
