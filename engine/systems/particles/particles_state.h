// Columns of a particles state. The first group has one row per particle, in order of birth, so that ids
// ascend; dead particles are removed without changing the order of the others. Whatever a command may change
// while the session runs (gravity, drag, surfaces ...) is here too.
#pragma once
#include "engine/collision/points/collider_set.h"
#include "engine/core/commands/user_forces.h"
#include "engine/core/state/state.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

namespace columns {
enum : State::Column {
  position,
  velocity,
  mass,   ///< kg
  birth,  ///< s
  death,  ///< s; infinity: never
  id,     ///< u64, ascending, never reused
  per_particle_end,
  time = per_particle_end,  ///< s, of this state
  next_particle,            ///< u64 per emitter: number of the next particle
  counters,                 ///< u64: see Counter
  parameters,               ///< f64: see Parameter
  attractors,               ///< f64 x 5: position, mu, softening
  surfaces,                 ///< f64 x 3 per collider: restitution, friction, rest speed
  spring_rows,              ///< u32 x 2
  spring_values,            ///< f64 x 3: stiffness, rest length, damping
  push_id,                  ///< u64
  push_force,               ///< f64 x 3, N
  push_remaining,           ///< f64, s
  drag_id,                  ///< u64
  drag_target,              ///< f64 x 3, m
  drag_stiffness,           ///< f64, N/m
  charge,                   ///< f64 per particle, C; only if the scene gives charges
};
inline constexpr UserForces kHands{{push_id, push_force, push_remaining},
                                   {drag_id, drag_target, drag_stiffness}};
}  // namespace columns

enum class Counter : uint8_t { next_id, emitted, killed, refused, count };
/// Indices in the column `parameters`; vectors take three.
enum class Parameter : uint8_t {
  gravity = 0,
  linear_drag = 3,
  quadratic_drag = 4,
  wind = 5,
  electric_field = 8,
  magnetic_field = 11,
  thrust = 14,
  count = 15,
};

inline Vec3 vector_parameter(const State& s, Parameter p) {
  return load3(s.f64(columns::parameters).data() + static_cast<size_t>(p), 0);
}
inline double parameter(const State& s, Parameter p) {
  return s.f64(columns::parameters)[static_cast<size_t>(p)];
}

/// The state at t = 0, with capacity for `capacity` particles.
State particles_at_start(const ParticlesDef& def, const ColliderSet& colliders, const Vec3& gravity,
                         uint64_t seed, size_t capacity);

/// Appends one particle; returns its id.
struct NewParticle {
  Vec3 x, v;
  double mass, birth, death;
  double charge = 0;  ///< kept when particles have individual charges
};
/// Whether the state has the column of charges.
inline bool has_charges(const State& s) {
  return s.columns() > columns::charge && s.info(columns::charge).name == "charge";
}
uint64_t append_particle(State& s, const NewParticle& p);

/// Row of the particle with this id, or empty.
std::optional<size_t> row_of(const State& s, uint64_t id);

/// Removes the rows with a non-zero flag, keeping the order of the others: in every per-particle column, in
/// the integrator's columns of the same length, and springs that lost an end.
void remove_rows(State& s, std::span<const uint8_t> dead, Workspace& workspace);

inline uint64_t& counter(State& s, Counter c) {
  return s.span<uint64_t>(columns::counters)[static_cast<size_t>(c)];
}
inline uint64_t counter(const State& s, Counter c) {
  return s.span<uint64_t>(columns::counters)[static_cast<size_t>(c)];
}

}  // namespace truestep::particles
