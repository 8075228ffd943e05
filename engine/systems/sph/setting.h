// What the particles of an sph system and their solver are built from, and what the solver reports.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "engine/core/state/real_column.h"
#include "engine/core/system.h"
#include "engine/kernels/sph/half_space.h"
#include "engine/kernels/sph/interface.h"
#include "engine/math/expression/place_texts.h"
#include "engine/systems/sph/inlet.h"
#include "engine/systems/sph/mesh_wall.h"

namespace truestep::sph {

namespace columns {
/// `density` is relative to the rest density; `push` and `flow` are the pressures of the solves for constant
/// density and for zero divergence, from which the next solves start.
inline constexpr State::Column position = 0, velocity = 1, density = 2, pressure = 3, push = 4, flow = 5,
                               gravity = 6, report = 7;
/// One past the columns with a row per particle. `ratio`, a particle's density over the system's, is one more
/// where densities differ; `layers` (the number of each nozzle's next layer) and `counts` exist where
/// particles come or go.
inline constexpr State::Column per_particle_end = gravity;
}  // namespace columns

/// Entries of the column `counts`.
namespace counts {
inline constexpr size_t emitted = 0, killed = 1, refused = 2, count = 3;
}  // namespace counts

/// Entries of the column `report`, for the last step. viscous_iterations exists where viscosity is solved
/// for.
namespace report {
inline constexpr size_t mean_error = 0, max_error = 1, substeps = 2, density_iterations = 3,
                        flow_iterations = 4, courant = 5, count = 6, viscous_iterations = count;
}

struct Setting {
  SphDef def;
  std::string id;
  size_t rows = 0, capacity = 0;                    ///< at the start; at most
  State::Column ratio = 0, layers = 0, counts = 0;  ///< columns that not every fluid has; 0: absent
  double lightest = 1;                              ///< the least density over the system's
  std::vector<Inlet> inlets;
  double volume = 0, mass = 0;  ///< m^3 and kg of a particle
  double cohesion = 0;          ///< m/s^2, largest acceleration of a pair by surface tension (tension.h)
  std::optional<PlaneInterface> interface;  ///< for surface tension by the model `interface`
  double support = 0;                       ///< m, radius of the kernel
  double kernel_w = 0, kernel_s = 0;        ///< volume times the kernel's factors of w and of s (1, 1/m^2)
  double sound = 0;                         ///< m/s, of wcsph
  double relaxation = 0.5;                  ///< 1, of the solves' gradient steps
  /// Rest density of a particle over the system's.
  double ratio_of(const State& s, size_t row) const {
    return ratio ? RealColumn<const double>(s, ratio).at(row) : 1;
  }
  /// m/s, speed at which wcsph compresses by less than 1 % under this gravity (m/s^2): ten times the expected
  /// speed.
  double sound_for(const Vec3& gravity) const;
  bool closed = false;         ///< whether the liquid fills a box without sides: it cannot separate
  double shifting = 0;         ///< 1, strength (shifting.h)
  PlaceTexts initial = {};     ///< m/s
  double fastest_initial = 0;  ///< m/s, of the particles at the start
  /// m/s, given at a place (m) by the scene's expressions.
  Vec3 initial_at(const Vec3& place) const;
  HalfSpace wall;
  ColliderSet colliders;
  std::vector<Images> images = {};  ///< of each of them
  std::vector<MeshWall> meshes;     ///< the colliders that are not in the set
  VolumeMap::Kernel kernel() const { return {def.kernel, support, def.spacing}; }
};

class Solver {
 public:
  virtual ~Solver() = default;
  /// Error Instability where more substeps than allowed would be needed.
  virtual void step(State& s, const StepInput& in) const = 0;
  /// Pa, of all rows: what the liquid transmits beside each particle (transmitted.h).
  virtual void read_pressures(const State& s, std::vector<double>& out) const = 0;
  /// 1/s, the largest magnitude of the velocity's divergence (divergence.h).
  virtual double read_divergence(const State& s) const = 0;
};

/// Adds the layers that nozzles have emitted before time t (s), at their current positions; particles without
/// room are left out.
void pour(const Setting& set, State& s, double t, Workspace& workspace);
/// Removes the particles inside kill regions.
void remove_killed(const Setting& set, State& s, const StepInput& in);

/// m, initial positions of a body's particles, in the order of rows, without those in walls.
std::vector<Vec3> wet_places(const Setting& set, const BodyDef& body);

std::unique_ptr<const Setting> settle(const SphDef& def, const std::string& id, const Vec3& gravity);
/// The solver for the setting; the setting must outlive it.
std::unique_ptr<const Solver> make_solver(const Setting& setting);

}  // namespace truestep::sph
