// Parameters of the system "particles"; units and bounds are in the table (particles_def.cc).
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/collision/points/kill_def.h"
#include "engine/core/def/source_def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"

namespace truestep::particles {

/// Particles present at t = 0, spread over a box or a ball.
struct FillDef {
  enum class Shape { box, sphere } shape = Shape::box;
  enum class Arrangement { lattice, random } arrangement = Arrangement::lattice;
  Vec3 center, half_extents{0.5, 0.5, 0.5};
  double radius = 0.5;
  int64_t count = 1000;
  Vec3 velocity, spin;
  double speed_spread = 0;
};

/// A source of particles: a pure function of (seed, emitter, particle number).
struct EmitterDef : SourceDef {
  enum class Shape { point, disk, box, sphere, line } shape = Shape::point;
  Vec3 half_extents{0.1, 0.1, 0.1}, end{1, 0, 0};
  double rate = 0;
  std::vector<double> bursts;
  int64_t burst_count = 100;
  double speed_spread = 0, cone = 0;
  std::optional<double> lifetime;
  double lifetime_spread = 0;
  std::optional<double> mass;
};

struct AttractorDef {
  Vec3 position;
  double mu = 1, softening = 0;
};

/// F = strength r / (r^2 + softening^2)^((exponent + 1) / 2) towards the other particle.
struct PowerLawDef {
  double strength = 1, cutoff = 1, softening = 0;
  int64_t exponent = 2;
};
/// F = stiffness (cutoff - r) away from the other particle.
struct SoftRepulsionDef {
  double stiffness = 100, cutoff = 0.1;
};
/// F = coefficient (1 - r / cutoff)^2 (v_j - v_i).
struct ViscosityDef {
  double coefficient = 0.1, cutoff = 0.1;
};
using PairForceDef = std::variant<PowerLawDef, SoftRepulsionDef, ViscosityDef>;

struct PairSpringDef {
  int64_t a = 0, b = 1;
  double stiffness = 100, damping = 0;
  std::optional<double> rest_length;
};

struct PropulsionDef {
  double thrust = 1;
  enum class Along { velocity, direction } along = Along::velocity;
  Vec3 direction{0, 1, 0};
};

/// Electrostatics between all particles.
enum class CoulombMethod : uint8_t { automatic, direct, tree };
struct CoulombDef {
  double constant = 8.9875517873681764e9, softening = 0;
  CoulombMethod method = CoulombMethod::automatic;
  double force_error = 1e-3;
};

struct NamedNumberDef {
  std::string name;
  double value = 0;
};
/// Force as expressions in x y z vx vy vz t m and user-defined constants.
struct ExpressionDef {
  std::string fx = "0", fy = "0", fz = "0";
  std::vector<NamedNumberDef> constants;
};

struct ParticlesDef : IntegratorParams, KillDefs {
  std::vector<Vec3> positions, velocities;
  std::vector<double> masses, charges;
  std::vector<FillDef> fill;
  std::vector<EmitterDef> emitters;
  double mass = 1, radius = 0, charge = 0;
  std::optional<Vec3> gravity;
  double linear_drag = 0, quadratic_drag = 0;
  Vec3 wind, electric_field, magnetic_field;
  std::vector<AttractorDef> attractors;
  std::vector<PairForceDef> pair_forces;
  std::vector<PairSpringDef> springs;
  std::optional<CoulombDef> coulomb;
  std::optional<PropulsionDef> propulsion;
  std::optional<ExpressionDef> expression;
  ColliderDefs colliders;
  std::optional<int64_t> max_particles;
  double draw_radius = 0.02;
  std::optional<Vec3> color;
};

const DefTable& particles_table();
/// Its outputs.
const Outputs& particles_outputs();

/// Number of particles at t = 0.
size_t initial_count(const ParticlesDef& def);
/// Largest possible number of particles at once: max_particles, or what the emitters can keep alive.
size_t largest_count(const ParticlesDef& def);

}  // namespace truestep::particles
