#include "engine/systems/particles/particles_def.h"

#include <algorithm>

namespace truestep::particles {
namespace {

constexpr size_t kMostParticles = 10'000'000, kMostCharges = 100'000;

const DefTable& fill_table() {
  using D = FillDef;
  static const DefTable t =
      TableOf<D>("particles at t = 0, spread over a box or a ball")
          .choice("shape", &D::shape, {"box", "sphere"}, "region to fill")
          .choice("arrangement", &D::arrangement, {"lattice", "random"}, "regular or uniformly random")
          .vector("center", &D::center, "m", any(), "centre of the region")
          .vector("half_extents", &D::half_extents, "m", at_least(0), "half edges of a box")
          .number("radius", &D::radius, "m", above(0), "radius of a ball")
          .integer("count", &D::count, between(1, kMostParticles), "number of particles")
          .vector("velocity", &D::velocity, "m/s", any(), "velocity of all")
          .vector("spin", &D::spin, "rad/s", any(), "adds spin x (position - center) to the velocity")
          .number("speed_spread", &D::speed_spread, "m/s", at_least(0),
                  "adds a random velocity, uniform in a ball of this size")
          .build();
  return t;
}

const DefTable& emitter_table() {
  using D = EmitterDef;
  static const DefTable t = [] {
    TableOf<D> table("a source of particles, born at exact times between steps");
    table.choice("shape", &D::shape, {"point", "disk", "box", "sphere", "line"},
                 "region where particles are born");
    return add_source_rows(table)
        .vector("half_extents", &D::half_extents, "m", at_least(0), "half edges of the box")
        .vector("end", &D::end, "m", any(), "other end of the line")
        .number("rate", &D::rate, "1/s", between(0, 1e7),
                "particles per second; either rate or bursts, not both")
        .numbers("bursts", &D::bursts, "s", at_least(0), {0, 10000},
                 "times at which burst_count particles are born at once, ascending; either bursts or rate, "
                 "not both")
        .integer("burst_count", &D::burst_count, between(1, kMostParticles), "particles per burst")
        .number("speed_spread", &D::speed_spread, "m/s", at_least(0), "speeds are uniform within +- this")
        .number("cone", &D::cone, "rad", between(0, 3.141592653589793),
                "half angle about the direction, uniform in solid angle")
        .number("lifetime", &D::lifetime, "s", above(0), "mean lifetime; absent: unlimited")
        .number("lifetime_spread", &D::lifetime_spread, "s", at_least(0),
                "lifetimes are uniform within +- this")
        .number("mass", &D::mass, "kg", above(0), "of each particle; absent: the system's mass")
        .check([](const D& d, const DefTable::Report& report) {
          check_source(d, report);
          if (d.rate > 0 && !d.bursts.empty()) report("/bursts", "give rate or bursts, not both");
          if (static_cast<double>(d.bursts.size()) * static_cast<double>(d.burst_count) > kMostParticles) {
            report("/burst_count", "all bursts together are more than ten million particles");
          }
          if (!std::is_sorted(d.bursts.begin(), d.bursts.end())) {
            report("/bursts", "the burst times must be ascending");
          }
          if (d.lifetime && d.lifetime_spread >= *d.lifetime) {
            report("/lifetime_spread", "the spread must be smaller than the lifetime");
          }
        })
        .build();
  }();
  return t;
}

const DefTable& attractor_table() {
  using D = AttractorDef;
  static const DefTable t =
      TableOf<D>("acceleration mu r / (r^2 + softening^2)^(3/2) towards a point")
          .vector("position", &D::position, "m", any(), "the point")
          .number("mu", &D::mu, "m^3/s^2", any(), "G M; negative repels")
          .number("softening", &D::softening, "m", at_least(0), "length below which the attraction weakens")
          .build();
  return t;
}

const DefTable& power_law_table() {
  using D = PowerLawDef;
  static const DefTable t =
      TableOf<D>("force strength r / (r^2 + softening^2)^((exponent + 1) / 2) between particles")
          .number("strength", &D::strength, "1", any(), "N m^exponent; positive attracts, negative repels")
          .integer("exponent", &D::exponent, between(1, 12), "power of the distance")
          .number("softening", &D::softening, "m", at_least(0), "length below which the force weakens")
          .number("cutoff", &D::cutoff, "m", above(0), "no force beyond this distance")
          .build();
  return t;
}

const DefTable& soft_repulsion_table() {
  using D = SoftRepulsionDef;
  static const DefTable t = TableOf<D>("force stiffness (cutoff - r) that keeps particles apart")
                                .number("stiffness", &D::stiffness, "N/m", at_least(0), "slope of the force")
                                .number("cutoff", &D::cutoff, "m", above(0), "no force beyond this distance")
                                .build();
  return t;
}

const DefTable& viscosity_table() {
  using D = ViscosityDef;
  static const DefTable t =
      TableOf<D>(
          "force coefficient (1 - r / cutoff)^2 (v_j - v_i) that equalises the velocities of neighbours")
          .number("coefficient", &D::coefficient, "N s/m", at_least(0), "strength at r = 0")
          .number("cutoff", &D::cutoff, "m", above(0), "no force beyond this distance")
          .build();
  return t;
}

const DefTable& spring_table() {
  using D = PairSpringDef;
  static const DefTable t =
      TableOf<D>("spring between two particles that exist at t = 0")
          .integer("a", &D::a, at_least(0), "one end: positions first, then fills, in order")
          .integer("b", &D::b, at_least(0), "the other end")
          .number("stiffness", &D::stiffness, "N/m", at_least(0), "spring constant")
          .number("damping", &D::damping, "N s/m", at_least(0), "damping along the spring")
          .number("rest_length", &D::rest_length, "m", at_least(0), "absent: the distance at t = 0")
          .build();
  return t;
}

const DefTable& propulsion_table() {
  using D = PropulsionDef;
  static const DefTable t =
      TableOf<D>("a motor in every particle")
          .number("thrust", &D::thrust, "N", any(), "force")
          .choice("along", &D::along, {"velocity", "direction"}, "direction of the thrust")
          .vector("direction", &D::direction, "1", any(), "for along direction; any length")
          .build();
  return t;
}

const DefTable& coulomb_table() {
  using D = CoulombDef;
  static const DefTable t =
      TableOf<D>("force constant q_i q_j / r^2 between all particles")
          .number("constant", &D::constant, "N m^2/C^2", any(),
                  "1/(4 pi eps_0); negative: like charges attract")
          .number("softening", &D::softening, "m", at_least(0), "replaces r^2 by r^2 + softening^2")
          .choice("method", &D::method, {"auto", "direct", "tree"},
                  "all pairs; a tree for the charges of either sign; auto: pairs up to 5,000 particles")
          .number("force_error", &D::force_error, "1", between(1e-6, 0.05),
                  "with the tree: relative error of the force of the charges of one sign on a particle, root "
                  "mean square")
          .build();
  return t;
}

const DefTable& constant_table() {
  using D = NamedNumberDef;
  static const DefTable t = TableOf<D>("a constant of the expressions")
                                .text("name", &D::name, "letters, digits and _")
                                .required()
                                .number("value", &D::value, "", any(), "its value")
                                .required()
                                .build();
  return t;
}

const DefTable& expression_table() {
  using D = ExpressionDef;
  static const DefTable t =
      TableOf<D>(
          "force (N) as expressions of x y z vx vy vz t m pi and own constants; + - * / ^, sqrt abs "
          "sin cos tan asin acos atan atan2 exp log pow min max sign floor")
          .text("fx", &D::fx, "x component")
          .text("fy", &D::fy, "y component")
          .text("fz", &D::fz, "z component")
          .objects("constants", &D::constants, constant_table(), {0, 64}, "names and values")
          .build();
  return t;
}

void check(const ParticlesDef& d, const DefTable::Report& report) {
  if (!d.velocities.empty() && d.velocities.size() != d.positions.size()) {
    report("/velocities", "needs as many velocities as positions, or none");
  }
  if (!d.masses.empty() && d.masses.size() != d.positions.size()) {
    report("/masses", "needs as many masses as positions, or none");
  }
  if (!d.charges.empty() && d.charges.size() != d.positions.size()) {
    report("/charges", "needs as many charges as positions, or none");
  }
  const size_t n = initial_count(d);
  if (d.coulomb && d.charge == 0 && d.charges.empty()) {
    report("/coulomb", "particles without a charge do not act on each other");
  }
  if (d.coulomb && d.coulomb->method == CoulombMethod::direct && largest_count(d) > kMostCharges) {
    report("/coulomb/method", "all pairs are summed: at most 100,000 particles");
  }
  for (size_t i = 0; i < d.springs.size(); ++i) {
    const PairSpringDef& s = d.springs[i];
    const std::string at = "/springs/" + std::to_string(i);
    if (static_cast<size_t>(s.a) >= n) report(at + "/a", "there is no such particle at t = 0");
    if (static_cast<size_t>(s.b) >= n) report(at + "/b", "there is no such particle at t = 0");
    if (s.a == s.b) report(at + "/b", "a spring joins two different particles");
  }
  if (d.max_particles && static_cast<size_t>(*d.max_particles) < n) {
    report("/max_particles", "fewer than the particles at t = 0");
  }
  if (n == 0 && d.emitters.empty()) report("", "no positions, fill or emitters: nothing to simulate");
}

}  // namespace

const DefTable& particles_table() {
  using D = ParticlesDef;
  static const DefTable t = [] {
    TableOf<D> table("points with forces, emitters and obstacles");
    table.vectors("positions", &D::positions, "m", any(), {0, kMostParticles}, "particles at t = 0")
        .vectors("velocities", &D::velocities, "m/s", any(), {0, kMostParticles},
                 "one per position; absent: at rest")
        .numbers("masses", &D::masses, "kg", above(0), {0, kMostParticles},
                 "one per position; absent: the system's mass")
        .numbers("charges", &D::charges, "C", any(), {0, kMostParticles},
                 "one per position; absent: the system's charge")
        .objects("fill", &D::fill, fill_table(), {0, 100}, "regions filled with particles at t = 0")
        .objects("emitters", &D::emitters, emitter_table(), {0, 256}, "sources of particles")
        .integer("max_particles", &D::max_particles, between(1, kMostParticles),
                 "most particles at once; absent: enough for the emitters")
        .number("mass", &D::mass, "kg", above(0), "of each particle")
        .number("radius", &D::radius, "m", at_least(0), "distance kept from colliders")
        .number("charge", &D::charge, "C", any(), "of each particle")
        .vector("gravity", &D::gravity, "m/s^2", any(), "absent: the scene's")
        .number("linear_drag", &D::linear_drag, "N s/m", at_least(0), "force -linear_drag (v - wind)")
        .number("quadratic_drag", &D::quadratic_drag, "N s^2/m^2", at_least(0),
                "force -quadratic_drag |v - wind| (v - wind)")
        .vector("wind", &D::wind, "m/s", any(), "velocity of the air")
        .vector("electric_field", &D::electric_field, "V/m", any(), "force charge E")
        .vector("magnetic_field", &D::magnetic_field, "T", any(),
                "force charge v x B; integrator \"boris\" is exact in its rotation at any step")
        .objects("attractors", &D::attractors, attractor_table(), {0, 256}, "point gravity")
        .variants("pair_forces", &D::pair_forces,
                  {{"power_law", &power_law_table()},
                   {"soft_repulsion", &soft_repulsion_table()},
                   {"viscosity", &viscosity_table()}},
                  {0, 16}, "forces between neighbouring particles")
        .objects("springs", &D::springs, spring_table(), {0, 1'000'000}, "springs between particles")
        .object("coulomb", &D::coulomb, coulomb_table(), "electrostatics between all particles")
        .object("propulsion", &D::propulsion, propulsion_table(), "a motor in every particle")
        .object("expression", &D::expression, expression_table(), "a user-defined force");
    add_kill_rows(table)
        .number("draw_radius", &D::draw_radius, "m", at_least(0), "size in pictures, but at least radius")
        .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue");
    add_collider_rows(table, &D::colliders);
    return add_integrator_rows(table).check(check).build();
  }();
  return t;
}

size_t initial_count(const ParticlesDef& d) {
  size_t n = d.positions.size();
  for (const FillDef& f : d.fill) n += static_cast<size_t>(f.count);
  return n;
}

size_t largest_count(const ParticlesDef& d) {
  if (d.max_particles) return static_cast<size_t>(*d.max_particles);
  double n = static_cast<double>(initial_count(d));
  for (const EmitterDef& e : d.emitters) {
    // Longest life, plus one step's worth of slack in the counts.
    const double life = e.lifetime ? *e.lifetime + e.lifetime_spread : 1e300;
    const double open = e.stop ? std::max(*e.stop - e.start, 0.0) : 1e300;
    n += e.rate > 0 ? e.rate * std::min(life, open) * 1.05 + 64 : 0;
    size_t alive = 0;
    for (size_t first = 0, k = 0; k < e.bursts.size(); ++k) {
      while (e.bursts[k] - e.bursts[first] > life) ++first;
      alive = std::max(alive, k - first + 1);
    }
    n += static_cast<double>(alive) * static_cast<double>(e.burst_count);
  }
  // Without a foreseeable end: a default that the scene can raise.
  if (!(n < kMostParticles)) return std::max<size_t>(initial_count(d), 100'000);
  return std::max<size_t>(static_cast<size_t>(n), 1);
}

}  // namespace truestep::particles
