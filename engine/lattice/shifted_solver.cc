#include "engine/lattice/shifted_solver.h"

namespace truestep::lattice {

std::unique_ptr<ShiftedSolver> make_shifted_solver(const LatticeModel&, const Constants&, double,
                                                   const Diffusion&) {
  return nullptr;
}

}  // namespace truestep::lattice
