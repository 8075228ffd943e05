#include "engine/systems/nbody/nbody_def.h"

#include <algorithm>

#include "engine/math/trig.h"

namespace truestep::nbody {

namespace {

constexpr size_t kMost = kMostBodies;

template <class D>
TableOf<D>& add_place(TableOf<D>& table) {
  Vec3 D::*center = &Placed::center;
  Vec3 D::*velocity = &Placed::velocity;
  return table.vector("center", center, "m", any(), "where its middle is")
      .vector("velocity", velocity, "m/s", any(), "of the whole");
}

const DefTable& plummer_table() {
  using D = PlummerDef;
  static const DefTable t = [] {
    TableOf<D> table("Plummer's sphere in equilibrium, the usual model of a star cluster");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies")
        .number("mass", &D::mass, "kg", above(0), "of all together")
        .number("radius", &D::radius, "m", above(0), "Plummer's a: half the mass is within 1.305 of it")
        .number("cut", &D::cut, "1", above(1), "radii beyond which no body is put");
    return add_place(table).build();
  }();
  return t;
}

const DefTable& sphere_table() {
  using D = SphereDef;
  static const DefTable t = [] {
    TableOf<D> table("a ball of even density; at rest it falls into itself");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies")
        .number("mass", &D::mass, "kg", above(0), "of all together")
        .number("radius", &D::radius, "m", above(0), "of the ball")
        .number("virial_ratio", &D::virial_ratio, "1", between(0, 10),
                "twice the kinetic energy of random motion over the potential energy; 1 is balance");
    return add_place(table).build();
  }();
  return t;
}

const DefTable& galaxy_table() {
  using D = GalaxyDef;
  static const DefTable t = [] {
    TableOf<D> table("an exponential disk that turns, with a body in the middle and a halo if wanted");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies of the disk")
        .number("mass", &D::mass, "kg", above(0), "of the disk")
        .number("scale_length", &D::scale_length, "m", above(0), "over which the density falls by e")
        .number("height", &D::height, "m", at_least(0), "the density goes as 1/cosh^2 (z / height)")
        .number("dispersion", &D::dispersion, "1", between(0, 1), "random speeds over the speed on a circle")
        .number("central_mass", &D::central_mass, "kg", at_least(0), "of a body in the middle; 0: none")
        .integer("halo_count", &D::halo_count, between(0, kMostBodies), "bodies of a Plummer sphere around")
        .number("halo_mass", &D::halo_mass, "kg", at_least(0), "of that sphere")
        .number("halo_radius", &D::halo_radius, "m", above(0), "Plummer's a")
        .vector("axis", &D::axis, "1", any(), "about which the disk turns")
        .check([](const D& d, const DefTable::Report& report) {
          if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
          if ((d.halo_count > 0) != (d.halo_mass > 0)) {
            report("/halo_mass", "a halo has both bodies (halo_count) and a mass");
          }
        });
    return add_place(table).build();
  }();
  return t;
}

const DefTable& ring_table() {
  using D = RingDef;
  static const DefTable t =
      TableOf<D>("bodies on circles around one of the bodies")
          .integer("count", &D::count, between(1, kMostBodies), "bodies")
          .integer("around", &D::around, at_least(0), "row of the body in the middle")
          .number("mass", &D::mass, "kg", at_least(0), "of all together; 0: they attract nobody")
          .number("inner_radius", &D::inner_radius, "m", above(0), "of the smallest circle")
          .number("outer_radius", &D::outer_radius, "m", above(0), "of the largest")
          .number("thickness", &D::thickness, "m", at_least(0), "from the lowest to the highest")
          .number("body_radius", &D::body_radius, "m", at_least(0), "of a body")
          .vector("axis", &D::axis, "1", any(), "about which they turn")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
            if (!(d.outer_radius >= d.inner_radius)) report("/outer_radius", "at least the inner radius");
          })
          .build();
  return t;
}

const DefTable& orbit_table() {
  using D = OrbitDef;
  static const DefTable t =
      TableOf<D>("a body on a Kepler ellipse around another, by its elements")
          .integer("around", &D::around, at_least(0), "row of the body in the focus")
          .number("mass", &D::mass, "kg", at_least(0), "its mass")
          .number("radius", &D::radius, "m", at_least(0), "its radius")
          .number("semi_major_axis", &D::semi_major_axis, "m", above(0), "half the longer axis")
          .number("eccentricity", &D::eccentricity, "1", between(0, 0.999), "0: a circle")
          .number("inclination", &D::inclination, "rad", any(), "against the x-y plane")
          .number("ascending_node", &D::ascending_node, "rad", any(),
                  "from x to where it rises through the plane")
          .number("periapsis", &D::periapsis, "rad", any(), "argument: from the node to the nearest point")
          .number("mean_anomaly", &D::mean_anomaly, "rad", any(), "at t = 0")
          .build();
  return t;
}

const DefTable& collisions_table() {
  using D = CollisionsDef;
  static const DefTable t =
      TableOf<D>("what bodies do whose balls touch")
          .choice("response", &D::response, {"merge", "bounce", "stop"},
                  "become one body, bounce off each other, or lose their relative velocity")
          .number("restitution", &D::restitution, "1", between(0, 1), "for bounce: of the normal velocity")
          .build();
  return t;
}

void check_counts(const NbodyDef& d, const DefTable::Report& report) {
  const size_t n = d.positions.size(), all = body_count(d);
  const auto as_many = [&](const char* pointer, size_t count, const char* what) {
    if (count != 0 && count != n) report(pointer, std::string("as many ") + what + " as positions, or none");
  };
  as_many("/velocities", d.velocities.size(), "velocities");
  as_many("/masses", d.masses.size(), "masses");
  as_many("/radii", d.radii.size(), "radii");
  if (all == 0) report("", "no positions and no groups: nothing to simulate");
  if (all > kMost) report("/groups", "more than " + std::to_string(kMost) + " bodies");
}

void check(const NbodyDef& d, const DefTable::Report& report) {
  check_counts(d, report);
  size_t before = d.positions.size();
  for (size_t k = 0; k < d.groups.size(); ++k) {
    const auto known = [&](int64_t row) {
      if (static_cast<size_t>(row) < before) return;
      report("/groups/" + std::to_string(k) + "/around",
             before == 0 ? "there is no body before this group"
                         : "one of the bodies before this group: 0 to " + std::to_string(before - 1));
    };
    if (const auto* ring = std::get_if<RingDef>(&d.groups[k])) known(ring->around);
    if (const auto* orbit = std::get_if<OrbitDef>(&d.groups[k])) known(orbit->around);
    NbodyDef one;
    one.groups = {d.groups[k]};
    before += body_count(one);
  }
}

}  // namespace

const DefTable& nbody_table() {
  using D = NbodyDef;
  static const DefTable t = [] {
    TableOf<D> table("bodies that attract each other by Newton's law");
    table
        .number("gravitational_constant", &D::gravitational_constant, "m^3/(kg s^2)", at_least(0),
                "Newton's G; 1 for model units")
        .vectors("positions", &D::positions, "m", any(), {0, kMost}, "bodies at t = 0")
        .vectors("velocities", &D::velocities, "m/s", any(), {0, kMost}, "one per position; absent: at rest")
        .numbers("masses", &D::masses, "kg", at_least(0), {0, kMost},
                 "one per position; 0: attracts nobody; absent: the system's mass")
        .numbers("radii", &D::radii, "m", at_least(0), {0, kMost},
                 "one per position; absent: the system's radius")
        .number("mass", &D::mass, "kg", at_least(0), "of each body at positions")
        .number("radius", &D::radius, "m", at_least(0), "of each body, for collisions")
        .variants("groups", &D::groups,
                  {{"plummer", &plummer_table()},
                   {"sphere", &sphere_table()},
                   {"galaxy", &galaxy_table()},
                   {"ring", &ring_table()},
                   {"orbit", &orbit_table()}},
                  {0, 10'000},
                  "bodies by rules; rows are counted through positions and groups in their order")
        .choice("softening_kind", &D::softening_kind, {"plummer", "spline"},
                "how attraction weakens near a body: everywhere a little, or within 2.8 softenings only")
        .number("softening", &D::softening, "m", at_least(0), "length below which attraction weakens")
        .choice("method", &D::method, {"auto", "direct", "mixed", "tree", "fmm"},
                "all pairs, exact; all pairs, most in floats, error some 1e-7; a tree of bodies, for many; "
                "the fast "
                "multipole method, for very many; auto: whatever is fastest for force_error")
        .number("force_error", &D::force_error, "1", between(1e-6, 0.05),
                "of tree and fmm: error of an acceleration over its size, root mean square over the bodies")
        .object("collisions", &D::collisions, collisions_table(), "absent: bodies pass through each other")
        .number("draw_radius", &D::draw_radius, "m", at_least(0),
                "size in pictures; absent: by the scene's size")
        .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue");
    return add_integrator_rows(table).check(check).build();
  }();
  return t;
}

size_t body_count(const NbodyDef& d) {
  double n = static_cast<double>(d.positions.size());
  for (const GroupDef& g : d.groups) {
    if (const auto* plummer = std::get_if<PlummerDef>(&g)) n += static_cast<double>(plummer->count);
    if (const auto* sphere = std::get_if<SphereDef>(&g)) n += static_cast<double>(sphere->count);
    if (const auto* ring = std::get_if<RingDef>(&g)) n += static_cast<double>(ring->count);
    if (std::holds_alternative<OrbitDef>(g)) n += 1;
    if (const auto* galaxy = std::get_if<GalaxyDef>(&g)) {
      n += static_cast<double>(galaxy->count + galaxy->halo_count) + (galaxy->central_mass > 0 ? 1 : 0);
    }
  }
  return static_cast<size_t>(std::min(n, 1e15));
}

namespace {

/// s per evaluation on one core, measured: half a pair, and the interactions of a body in the tree.
double direct_seconds(const NbodyDef& d, double n) {
  const bool spline = d.softening_kind == gravity::SofteningKind::spline && d.softening > 0;
  return n * n * (spline ? 1.4e-9 : 0.75e-9);
}
double tree_seconds(const NbodyDef& d, double n) {
  // A body interacts with about 140 more for every tenfold number of bodies, times (1/error)^0.6.
  const double met = (400 + 61 * trig::log(std::max(n, 1e3) / 1e3)) * trig::pow(2e-3 / d.force_error, 0.6);
  return n * (5e-8 + 1.25e-9 * std::min(met, 0.8 * n) * (d.softening > 0 ? 1 : 1.4));
}

}  // namespace

Method chosen_method(const NbodyDef& d, size_t n) {
  // Measured: beyond this, sharing between groups pays for the downward pass.
  constexpr size_t kShared = 50'000;
  if (d.method != Method::automatic) return d.method;
  const auto bodies = static_cast<double>(n);
  if (direct_seconds(d, bodies) <= tree_seconds(d, bodies)) return Method::direct;
  return n < kShared ? Method::tree : Method::fmm;
}

Cost nbody_cost(const void* def) {
  const auto& d = *static_cast<const NbodyDef*>(def);
  const auto n = static_cast<double>(body_count(d));
  const Method method = chosen_method(d, body_count(d));
  const bool direct = method == Method::direct;
  const double sums = direct                    ? direct_seconds(d, n)
                      : method == Method::mixed ? n * n * 3e-10
                                                : tree_seconds(d, n);
  Cost c;
  c.state_bytes = n * 80 + 2e3;
  c.workspace_bytes = n * (direct ? 60 + 24 * std::clamp(n / 256, 1.0, 8.0) : 280);
  c.elements = n;
  if (d.collisions) c.workspace_bytes += 130 * n;
  // ias15 has seven stages, iterated two or three times.
  const bool by_itself = d.integrator.empty() && body_count(d) <= kFewBodies;
  const bool divides = by_itself || d.integrator == "ias15" || d.integrator == "hermite";
  const double evaluations = divides ? 20 : 1;
  if (evaluations > 1) c.state_bytes += 400 * n;
  c.seconds_per_step = 1e-6 + evaluations * (n * 1e-8 + sums);
  return c;
}

}  // namespace truestep::nbody
