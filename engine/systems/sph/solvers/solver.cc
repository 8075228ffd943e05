// The solver for a scene's dimension.
#include "engine/systems/sph/solvers/make_solver.h"

namespace truestep::sph {

std::unique_ptr<const Solver> make_solver(const Setting& s) {
  return s.def.dimension == 2 ? make_plane_solver(s) : make_space_solver(s);
}

}  // namespace truestep::sph
