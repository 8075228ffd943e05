// What a system of particles of fluid is built of, and what its solver leaves behind for those who look.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "engine/core/real_column.h"
#include "engine/core/system.h"
#include "engine/kernels/sph/half_space.h"
#include "engine/kernels/sph/interface.h"
#include "engine/systems/sph/inlet.h"

namespace truestep::sph {

namespace columns {
/// `density` is relative to the fluid's at rest; `push` and `flow` are the pressures of the solves for
/// constant density and for no divergence that the next ones begin from.
inline constexpr State::Column position = 0, velocity = 1, density = 2, pressure = 3, push = 4, flow = 5,
                               gravity = 6, report = 7;
/// One past the columns that have a row for each particle. `ratio`, a particle's density over the system's,
/// is one more where not all are alike; `layers` (of each nozzle the next one's number) and `counts` are
/// there where particles come or go.
inline constexpr State::Column per_particle_end = gravity;
}  // namespace columns

/// Entries of the column `counts`.
namespace counts {
inline constexpr size_t emitted = 0, killed = 1, refused = 2, count = 3;
}  // namespace counts

/// Entries of the column `report`: of the last step. The last one is there where viscosity is solved for.
namespace report {
inline constexpr size_t mean_error = 0, max_error = 1, substeps = 2, density_iterations = 3,
                        flow_iterations = 4, courant = 5, count = 6, viscous_iterations = count;
}

struct Setting {
  SphDef def;
  std::string id;
  size_t rows = 0, capacity = 0;                    ///< at the start; at most
  State::Column ratio = 0, layers = 0, counts = 0;  ///< columns that not every fluid has; 0: it has not
  double lightest = 1;                              ///< the least density over the system's
  std::vector<Inlet> inlets;
  double volume = 0, mass = 0;              ///< m^3 and kg of a particle
  double cohesion = 0;                      ///< m/s^2, that surface tension gives a pair at most (tension.h)
  std::optional<PlaneInterface> interface;  ///< of the tension that is an interface's
  double support = 0;                       ///< m, radius of the kernel
  double kernel_w = 0, kernel_s = 0;        ///< volume times the kernel's factors of w and of s (1, 1/m^2)
  double sound = 0;                         ///< m/s, of wcsph
  double relaxation = 0.5;                  ///< 1, of the solves' gradient steps
  /// Density at rest of a particle over the system's.
  double ratio_of(const State& s, size_t row) const {
    return ratio ? RealColumn<const double>(s, ratio).at(row) : 1;
  }
  HalfSpace wall;
  ColliderSet colliders;
};

class Solver {
 public:
  virtual ~Solver() = default;
  /// Error Instability where substeps would be more than are allowed.
  virtual void step(State& s, const StepInput& in) const = 0;
  /// Pa, of all rows: what the liquid transmits beside each particle (transmitted.h).
  virtual void read_pressures(const State& s, std::vector<double>& out) const = 0;
};

/// Adds the layers that nozzles have given birth to before time t (s), where they are then; nothing where
/// something is already.
void pour(const Setting& set, State& s, double t, Workspace& workspace);
/// Removes the particles that are in kill regions.
void remove_killed(const Setting& set, State& s, const StepInput& in);

std::unique_ptr<const Setting> settle(const SphDef& def, const std::string& id, const Vec3& gravity);
/// The solver for the setting; the setting must outlive it.
std::unique_ptr<const Solver> make_solver(const Setting& setting);

}  // namespace truestep::sph
