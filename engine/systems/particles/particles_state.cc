#include "engine/systems/particles/particles_state.h"

#include <algorithm>
#include <limits>

#include "engine/base/random.h"
#include "engine/systems/particles/sampling.h"

namespace truestep::particles {

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

void fill_region(State& s, const FillDef& f, double mass, double charge, uint64_t seed, uint64_t stream) {
  const auto count = static_cast<size_t>(f.count);
  const Vec3 half = f.shape == FillDef::Shape::box ? f.half_extents : Vec3{f.radius, f.radius, f.radius};
  const LatticeShape lattice = lattice_shape(count, half);
  uint64_t cell = 0;
  for (size_t i = 0; i < count; ++i) {
    Vec3 p;
    if (f.arrangement == FillDef::Arrangement::lattice && f.shape == FillDef::Shape::box) {
      p = lattice_point(lattice, i, half);
    } else if (f.arrangement == FillDef::Arrangement::lattice) {
      p = ball_spiral_point(i, count) * f.radius;
    } else {
      const auto u = uniform4(seed, stream, cell++);
      p = f.shape == FillDef::Shape::box
              ? Vec3{half.x * (2 * u[0] - 1), half.y * (2 * u[1] - 1), half.z * (2 * u[2] - 1)}
              : point_in_ball(u) * f.radius;
    }
    Vec3 v = f.velocity + cross(f.spin, p);
    if (f.speed_spread > 0) v += point_in_ball(uniform4(seed, stream + 1, i)) * f.speed_spread;
    append_particle(s, {f.center + p, v, mass, 0, kForever, charge});
  }
}

void add_springs(State& s, const ParticlesDef& def) {
  const double* x = s.f64(columns::position).data();
  uint32_t* rows = s.span<uint32_t>(columns::spring_rows).data();
  double* values = s.f64(columns::spring_values).data();
  for (size_t k = 0; k < def.springs.size(); ++k) {
    const PairSpringDef& d = def.springs[k];
    rows[2 * k] = static_cast<uint32_t>(d.a);
    rows[2 * k + 1] = static_cast<uint32_t>(d.b);
    const double apart = norm(load3(x, static_cast<size_t>(d.b)) - load3(x, static_cast<size_t>(d.a)));
    store3(values, k, Vec3{d.stiffness, d.rest_length.value_or(apart), d.damping});
  }
}

/// Rows of the columns that are not per particle, in the order of the enumeration.
void add_columns(State& s, const ParticlesDef& def, size_t colliders) {
  using S = Scalar;
  s.add({"position", "m", S::f64, 3, Role::position}, 0);
  s.add({"velocity", "m/s", S::f64, 3, Role::velocity}, 0);
  s.add({"mass", "kg", S::f64, 1}, 0);
  s.add({"birth", "s", S::f64, 1}, 0);
  s.add({"death", "s", S::f64, 1, Role::sentinel}, 0);  // infinity: never
  s.add({"id", "1", S::u64, 1}, 0);
  s.add({"time", "s", S::f64, 1}, 1);
  s.add({"emitter.next_particle", "1", S::u64, 1}, def.emitters.size());
  s.add({"counters", "1", S::u64, 1}, static_cast<size_t>(Counter::count));
  s.add({"parameters", "SI", S::f64, 1}, static_cast<size_t>(Parameter::count));
  s.add({"attractors", "SI", S::f64, 5}, def.attractors.size());
  s.add({"collider.surfaces", "SI", S::f64, 3}, colliders);
  s.add({"spring.rows", "1", S::u32, 2}, def.springs.size());
  s.add({"spring.values", "SI", S::f64, 3}, def.springs.size());
  s.add({"push.id", "1", S::u64, 1}, 0);
  s.add({"push.force", "N", S::f64, 3}, 0);
  s.add({"push.remaining", "s", S::f64, 1}, 0);
  s.add({"drag.id", "1", S::u64, 1}, 0);
  s.add({"drag.target", "m", S::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m", S::f64, 1}, 0);
  if (!def.charges.empty()) s.add({"charge", "C", S::f64, 1}, 0);
}

}  // namespace

State particles_at_start(const ParticlesDef& def, const ColliderSet& colliders, const Vec3& gravity,
                         uint64_t seed, size_t capacity) {
  State s;
  add_columns(s, def, colliders.colliders().size());
  for (State::Column c = 0; c < columns::per_particle_end; ++c) s.reserve(c, capacity);
  if (has_charges(s)) s.reserve(columns::charge, capacity);

  const auto set = [&s](Parameter p, const Vec3& v) {
    store3(s.f64(columns::parameters).data() + static_cast<size_t>(p), 0, v);
  };
  set(Parameter::gravity, def.gravity.value_or(gravity));
  set(Parameter::wind, def.wind);
  set(Parameter::electric_field, def.electric_field);
  set(Parameter::magnetic_field, def.magnetic_field);
  const auto numbers = s.f64(columns::parameters);
  numbers[static_cast<size_t>(Parameter::linear_drag)] = def.linear_drag;
  numbers[static_cast<size_t>(Parameter::quadratic_drag)] = def.quadratic_drag;
  numbers[static_cast<size_t>(Parameter::thrust)] = def.propulsion ? def.propulsion->thrust : 0;

  for (size_t i = 0; i < def.positions.size(); ++i) {
    append_particle(s, {def.positions[i], def.velocities.empty() ? Vec3{} : def.velocities[i],
                        def.masses.empty() ? def.mass : def.masses[i], 0, kForever,
                        def.charges.empty() ? def.charge : def.charges[i]});
  }
  // Streams of random numbers: emitters use those from 0 on, fills the top half.
  for (size_t k = 0; k < def.fill.size(); ++k) {
    fill_region(s, def.fill[k], def.mass, def.charge, seed, (uint64_t{1} << 63) + 2 * k);
  }

  double* attractors = s.f64(columns::attractors).data();
  for (const AttractorDef& a : def.attractors) {
    for (const double value : {a.position.x, a.position.y, a.position.z, a.mu, a.softening})
      *attractors++ = value;
  }
  double* surfaces = s.f64(columns::surfaces).data();
  for (const Collider& c : colliders.colliders()) {
    for (const double value : {c.surface.restitution, c.surface.friction, c.surface.rest_speed}) {
      *surfaces++ = value;
    }
  }
  add_springs(s, def);
  return s;
}

uint64_t append_particle(State& s, const NewParticle& p) {
  const size_t n = s.rows(columns::position);
  for (State::Column c = 0; c < columns::per_particle_end; ++c) s.resize(c, n + 1);
  store3(s.f64(columns::position).data(), n, p.x);
  store3(s.f64(columns::velocity).data(), n, p.v);
  s.f64(columns::mass)[n] = p.mass;
  s.f64(columns::birth)[n] = p.birth;
  s.f64(columns::death)[n] = p.death;
  if (has_charges(s)) {
    s.resize(columns::charge, n + 1);
    s.f64(columns::charge)[n] = p.charge;
  }
  uint64_t& next = s.span<uint64_t>(columns::counters)[static_cast<size_t>(Counter::next_id)];
  return s.span<uint64_t>(columns::id)[n] = next++;
}

std::optional<size_t> row_of(const State& s, uint64_t id) {
  const auto ids = s.span<uint64_t>(columns::id);
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  if (at == ids.end() || *at != id) return std::nullopt;
  return static_cast<size_t>(at - ids.begin());
}

}  // namespace truestep::particles
