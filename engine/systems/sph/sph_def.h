// Parameters of the system type "sph".
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/collision/points/kill_def.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/def/source_def.h"
#include "engine/core/outputs.h"
#include "engine/kernels/sph/smoothing.h"

namespace truestep::sph {

enum class Shape : uint8_t { box, ball };
enum class Method : uint8_t { dfsph, wcsph, pbf };
enum class Walls : uint8_t { slip, no_slip };
/// Bit a is set if the box is periodic along axis a.
enum class Periodic : uint8_t { none, x, y, xy, z, xz, yz, xyz };
enum class Tension : uint8_t { cohesion, interface };
enum class Viscous : uint8_t { explicit_step, implicit_step, weiler2018 };
enum class Precision : uint8_t { f32, f64 };

/// Fluid that fills a shape at the start.
struct BodyDef {
  Shape shape = Shape::box;
  Vec3 center, half_extents{0.1, 0.1, 0.1}, velocity, spin, strain;
  double radius = 0.1;
  std::optional<double> density;

  /// Whether it has no velocity of its own at the start.
  bool at_rest() const { return velocity == Vec3{} && spin == Vec3{} && strain == Vec3{}; }
};

/// A nozzle that emits liquid.
struct InletDef : SourceDef {
  std::optional<double> density;
};

/// A shape without fluid at the start.
struct HollowDef {
  Shape shape = Shape::box;
  Vec3 center, half_extents{0.1, 0.1, 0.1};
  double radius = 0.1;

  bool contains(const Vec3& p) const;
  /// As a wall that stands.
  Collider solid() const;
};

struct SphDef : KillDefs {
  int dimension = 3;
  Vec3 low, high{1, 1, 1};
  double spacing = 0.025;
  std::vector<BodyDef> bodies;
  std::vector<std::string> initial;
  std::vector<HollowDef> hollows;
  double settle = 0;
  std::vector<InletDef> emitters;
  std::optional<int64_t> max_particles;
  Method solver = Method::dfsph;
  Smoothing kernel = Smoothing::cubic;
  double support = 2;
  double density = 1000, viscosity = 1e-6, artificial_viscosity = 0.02, xsph = 0.5, vorticity = 0;
  std::optional<double> shifting;
  Viscous viscosity_step = Viscous::explicit_step;
  double surface_tension = 0;
  Tension surface_tension_model = Tension::cohesion;
  double density_error = 1e-4;
  int max_iterations = 200;
  double sound_speed = 0, density_diffusion = 0.1;
  int pbf_iterations = 4;
  double artificial_pressure = 0;
  double courant = 0.4;
  int max_substeps = 10'000;
  Walls walls = Walls::slip;
  Vec3 lid_velocity;
  Periodic periodic = Periodic::none;
  AnyColliderDefs colliders;
  Precision precision = Precision::f32;

  /// Whether viscosity is solved for in every substep.
  bool solves_viscosity() const { return viscosity > 0 && viscosity_step != Viscous::explicit_step; }
  /// Whether the number of particles can change.
  bool changes() const { return !emitters.empty() || any_regions(); }
  /// Whether parts of the liquid have different densities.
  bool layered() const;
  /// The same liquid, with the density that all its parts have, if they do, as the system's.
  SphDef with_common_density() const;
  /// Whether the box is periodic along every axis.
  bool without_sides() const { return wraps(0) && wraps(1) && (dimension == 2 || wraps(2)); }
  bool wraps(int axis) const { return (static_cast<unsigned>(periodic) >> axis & 1u) != 0; }
};

const DefTable& sph_table();
const Outputs& sph_outputs();
const Resolution& sph_resolution();
Cost sph_cost(const void* def);
/// On one core, of a step of h (s) in which liquid moves at `speed` (m/s) and sound at `sound` (m/s), under
/// `gravity` (m/s^2).
double sph_step_seconds(const SphDef& def, double h, double speed, double sound, double gravity);

/// m, initial positions of a body's particles, in the order of rows.
std::vector<Vec3> places_of(const SphDef& def, const BodyDef& body);
/// Largest number of particles at once, given `start` of them at the start.
size_t largest_count(const SphDef& def, size_t start);
/// Neighbours of a particle inside the fluid, including the padding of its list.
double expected_neighbours(const SphDef& def);
/// Number of particles of all bodies, from the lattices that fill them.
double expected_particles(const SphDef& def);

}  // namespace truestep::sph
