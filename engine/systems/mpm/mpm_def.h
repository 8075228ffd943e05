// Parameters of the system type "mpm".
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
#include "engine/kernels/mpm/laws.h"

namespace truestep::mpm {

enum class Shape : uint8_t { box, ball };
enum class Contact : uint8_t { sticky, slip, separate };
enum class Transfer : uint8_t { apic, flip };
enum class Splines : uint8_t { quadratic, cubic };
enum class Precision : uint8_t { f32, f64 };
enum class Integration : uint8_t { explicit_steps, implicit_steps };

/// Material parameters.
struct MaterialDef {
  Law material = Law::corotated;
  double density = 1000, youngs_modulus = 1e5, poisson_ratio = 0.3, bulk_modulus = 1e5;
  double hardening = 10, critical_compression = 0.025, critical_stretch = 0.0075;
  double friction_angle = 0.61, yield_stress = 1e3;
  std::string energy;
  int velocity_field = 0;
};

/// A shape filled with one material.
struct BodyDef : MaterialDef {
  Shape shape = Shape::box;
  Vec3 center, half_extents{0.1, 0.1, 0.1}, velocity, spin;
  double radius = 0.1, inner_radius = 0;
};

/// A nozzle that pours a material.
struct InletDef : SourceDef, MaterialDef {};

struct MpmDef : KillDefs {
  int dimension = 2;
  Vec3 low, high{1, 1, 1};
  double cell = 1.0 / 64;
  int particles_per_axis = 2;
  std::vector<BodyDef> bodies;
  std::vector<InletDef> emitters;
  std::optional<int64_t> max_particles;
  Splines splines = Splines::quadratic;
  Transfer transfer = Transfer::apic;
  double flip = 0.95;
  Integration integration = Integration::explicit_steps;
  double courant = 0.4;
  int max_substeps = 10'000;
  Contact walls = Contact::separate;
  enum class Floor : uint8_t { sticky, slip, separate, as_walls } floor = Floor::as_walls;
  double wall_friction = 0;
  Contact contact = Contact::separate;
  ColliderDefs colliders;
  double body_friction = 0.4, field_friction = 0.4;
  std::vector<std::string> force, exact;
  Precision precision = Precision::f32;

  bool is_implicit() const { return integration == Integration::implicit_steps; }
  /// Whether particles are emitted or removed.
  bool changes() const { return !emitters.empty() || any_regions(); }
  /// m, between emitted particles.
  double spacing() const { return cell / particles_per_axis; }
};

const DefTable& mpm_table();
const Outputs& mpm_outputs();
Cost mpm_cost(const void* def);
/// On one core, of a step of h (s): as many substeps as the stiffest material at rest requires.
double mpm_step_seconds(const MpmDef& def, double h);
const Resolution& mpm_resolution();

/// Indices of the velocity fields that bodies and nozzles name, in order.
std::vector<int> velocity_fields(const MpmDef& def);
/// Lame parameters and the rest of what the law needs.
Material material_of(const MaterialDef& of);
/// m, between the particles of a body along each axis.
Vec3 spacing_of(const MpmDef& def, const BodyDef& body);
/// m, initial positions of a body's particles, in the order of rows.
std::vector<Vec3> places_of(const MpmDef& def, const BodyDef& body);
/// Particles of all bodies, from the lattices that fill them.
double expected_particles(const MpmDef& def);
/// Largest number of particles at a time, with `start` of them initially.
size_t largest_count(const MpmDef& def, size_t start);
/// Number of blocks that hold n particles at their initial density.
double expected_blocks(const MpmDef& def, double n);

}  // namespace truestep::mpm
