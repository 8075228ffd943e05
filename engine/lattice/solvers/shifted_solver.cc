#include "engine/lattice/solvers/shifted_solver.h"

#include "engine/lattice/solvers/multigrid.h"
#include "engine/lattice/solvers/spectral_solver.h"

namespace truestep::lattice {

std::unique_ptr<ShiftedSolver> make_shifted_solver(const LatticeModel& model, const Constants& constants,
                                                   double t, const Diffusion& diffusion) {
  // In one dimension the matrix is a narrow band, which methods factorize themselves.
  if (model.lattice().dimensions == 1) return nullptr;
  if (SpectralSolver::serves(diffusion)) return std::make_unique<SpectralSolver>(diffusion);
  const auto discretise = [&model, constants, t](const Lattice& on) {
    Coefficient c = model.coefficient(on, constants, t);
    if (!c.variable()) {
      // Only Robin sides: the cycle reads coefficients node by node.
      c.nodes.assign(on.nodes(), c.constant);
      for (size_t a = 0; a < on.dimensions; ++a) c.faces[a].assign(on.nodes(), c.constant);
    }
    return Diffusion(on, 2, std::move(c));
  };
  return std::make_unique<MultigridSolver>(model.lattice(), discretise);
}

}  // namespace truestep::lattice
