// A step of the material point method in substeps (Hu et al. 2018; Jiang et al. 2015): masses and momenta
// with stresses from particles to tiles of nodes, tiles to blocks in a fixed order, node velocities with
// gravity and boundaries, and back to particles, whose deformation is updated and flows.
#pragma once
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/core/system.h"
#include "engine/math/expression/place_texts.h"
#include "engine/systems/mpm/energy.h"
#include "engine/systems/mpm/inlet.h"
#include "engine/systems/mpm/mpm_def.h"

namespace truestep::mpm {

namespace columns {
/// If particles are emitted or removed there are four more: `piece` and `id` of each particle, for each
/// nozzle the number of its next layer, and `counts`.
inline constexpr State::Column position = 0, velocity = 1, affine = 2, deformation = 3, plastic = 4,
                               jacobian = 5, gravity = 6, piece = 7, id = 8, layers = 9, counts = 10;
/// Columns with a row for each particle: the first six, and `piece` and `id` if present.
inline constexpr State::Column per_particle_end = gravity;
}  // namespace columns

/// Entries of the column `counts`; `born` includes the initial particles: it is the next particle's id.
namespace counts {
inline constexpr size_t emitted = 0, killed = 1, refused = 2, born = 3, count = 4;
}

/// Properties shared by all particles of a body or of a nozzle; its initial rows are [first, last).
struct Piece {
  Material material;
  size_t field = 0;              ///< index of its velocity field
  Vec3 spacing;                  ///< m, between particles along each axis at the start
  double density, mass, volume;  ///< kg/m^3, kg and m^3 of a particle
  size_t first, last;
  std::shared_ptr<const EnergyLaw> energy;  ///< for material elastic
};

/// Stress of a piece's material.
template <int D, class T>
Response<D, T> response(const Piece& p, const Square<D, T>& f, Wide<T> j, Wide<T> plastic) {
  return p.energy ? p.energy->response(f) : response(p.material, f, j, plastic);
}

struct Setting {
  MpmDef def;
  std::vector<Piece> pieces;  ///< bodies, then nozzles
  std::vector<Inlet> inlets;
  size_t capacity = 0;  ///< largest number of particles at a time
  size_t fields = 1;    ///< velocity fields
  ColliderSet colliders;
  PlaceTexts force, exact;  ///< m/s^2; m, for a particle that starts at x, y, z
  std::string id;

  /// Initial number of particles.
  size_t rows() const { return pieces.back().last; }
  /// Pieces of rows; empty if they are the initial ones.
  std::span<const uint32_t> pieces_of(const State& s) const {
    if (!def.changes()) return {};
    return s.span<uint32_t>(columns::piece);
  }
  /// Piece of a row, given what `pieces_of` returned.
  uint32_t piece_of(size_t row, std::span<const uint32_t> of_rows) const {
    if (!of_rows.empty()) return of_rows[row];
    if (pieces.size() == 1) return 0;
    const auto at = std::upper_bound(pieces.begin(), pieces.end(), row,
                                     [](size_t r, const Piece& p) { return r < p.last; });
    return static_cast<uint32_t>(at - pieces.begin());
  }
};

/// Visits runs of rows of one piece, in their order: visit(piece, begin, end).
template <class Visit>
void for_runs(const Setting& set, const State& s, const Visit& visit) {
  const std::span<const uint32_t> of = set.pieces_of(s);
  if (!set.def.changes()) {
    for (const Piece& p : set.pieces) visit(p, p.first, p.last);
    return;
  }
  for (size_t begin = 0, end; begin < of.size(); begin = end) {
    for (end = begin + 1; end < of.size() && of[end] == of[begin];) ++end;
    visit(set.pieces[of[begin]], begin, end);
  }
}

/// Adds the layers that nozzles have emitted by time t (s), at the positions they have reached; a particle
/// whose position is occupied is left out.
void pour(const Setting& set, State& s, double t, Workspace& workspace);
/// Removes the particles that are in kill regions.
void remove_killed(const Setting& set, State& s, const StepInput& in);

class Solver {
 public:
  virtual ~Solver() = default;
  /// Throws Instability if more substeps would be needed than are allowed.
  virtual void step(State& s, const StepInput& in) const = 0;
};

/// The solver for the setting's dimension, splines and precision; the setting must outlive it.
std::unique_ptr<const Solver> make_solver(const Setting& setting);

}  // namespace truestep::mpm
