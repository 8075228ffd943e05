// A step of the material point method in substeps (Hu et al. 2018; Jiang et al. 2015): masses and momenta
// with stresses from particles to tiles of nodes, tiles to blocks in a fixed order, velocities of nodes with
// gravity and boundaries, and back to particles, whose deformation follows and flows.
#pragma once
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/state.h"
#include "engine/core/system.h"
#include "engine/systems/mpm/mpm_def.h"
#include "engine/systems/mpm/texts.h"

namespace truestep::mpm {

namespace columns {
inline constexpr State::Column position = 0, velocity = 1, affine = 2, deformation = 3, plastic = 4,
                               jacobian = 5, gravity = 6;
}

/// What all particles of a body share; its rows are [first, last).
struct Piece {
  Material material;
  double density, mass, volume;  ///< kg/m^3, kg and m^3 of a particle
  size_t first, last;
};

struct Setting {
  MpmDef def;
  std::vector<Piece> pieces;
  ColliderSet colliders;
  Texts force, exact;  ///< m/s^2; m, of a particle that starts at x, y, z
  std::string id;

  size_t rows() const { return pieces.back().last; }
  uint32_t piece_of(size_t row) const {
    if (pieces.size() == 1) return 0;
    const auto at = std::upper_bound(pieces.begin(), pieces.end(), row,
                                     [](size_t r, const Piece& p) { return r < p.last; });
    return static_cast<uint32_t>(at - pieces.begin());
  }
};

class Solver {
 public:
  virtual ~Solver() = default;
  /// Error Instability where substeps would be more than are allowed.
  virtual void step(State& s, const StepInput& in) const = 0;
};

/// The solver for the setting's dimension, splines and precision; the setting must outlive it.
std::unique_ptr<const Solver> make_solver(const Setting& setting);

}  // namespace truestep::mpm
