// Viscosity of a liquid with a surface by one backward Euler step, component by component, on the faces
// that the liquid reaches:
//   V (u - u*) = h viscosity sum over neighbours of W (u_n - u) / dx^2
// V the wet fraction of the volume around a face, W that of the area between two of them (the weights of
// Batty, Bridson 2008, "Accurate viscous free surfaces for buckling, coiling, and rotating liquids", with
// div grad u instead of their div(grad u + grad u^T): components do not couple, so a rotating surface feels
// some friction). The air exerts no friction; walls and closed faces do. Conjugate gradients with the
// diagonal as preconditioner.
#pragma once
#include <vector>

#include "engine/lattice/solvers/cut_poisson.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

class FaceViscosity {
 public:
  /// Reserves what every later solve needs.
  void bind(const FlowModel& model, const MovingSolids& solids);
  /// Steps component c of u in place; closed faces have the velocity of their obstacle. `depth` (cells of
  /// liquid above each centre) and `liquid` are cell values, wrapped if the grid is periodic; `amount` = h
  /// viscosity (m^2).
  lattice::CutPoisson::Outcome solve(size_t c, const uint8_t* liquid, const double* depth, double amount,
                                     double tolerance, double* u, const ThreadArena& arena);

  static constexpr int kMostIterations = 1000;

 private:
  static constexpr int32_t kNone = -1;
  void find_faces(size_t c, const uint8_t* liquid, const double* depth);
  void join_faces(size_t c, double amount, const double* u);
  void multiply(const std::vector<double>& x, std::vector<double>& out, const ThreadArena& arena) const;

  const FlowModel* model_ = nullptr;
  const MovingSolids* solids_ = nullptr;
  std::vector<int32_t> row_;    ///< per face of the grid
  std::vector<uint32_t> face_;  ///< per row
  std::vector<double> share_, diagonal_;
  std::vector<double> push_;    ///< from obstacles next to a row's face
  std::vector<int32_t> other_;  ///< 2 d per row, kNone if absent
  std::vector<double> weight_;  ///< of them
  std::vector<double> x_, r_, p_, q_, z_;
};

}  // namespace truestep::grid_fluid
