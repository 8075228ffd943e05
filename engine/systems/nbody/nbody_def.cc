#include "engine/systems/nbody/nbody_def.h"

#include <algorithm>

#include "engine/kernels/gravity/body_tree.h"
#include "engine/math/trig.h"

namespace truestep::nbody {

namespace {

constexpr size_t kMost = kMostBodies;

template <class D>
TableOf<D>& add_place(TableOf<D>& table) {
  Vec3 D::*center = &Placed::center;
  Vec3 D::*velocity = &Placed::velocity;
  return table.vector("center", center, "m", any(), "position of its centre")
      .vector("velocity", velocity, "m/s", any(), "of the whole");
}

const DefTable& plummer_table() {
  using D = PlummerDef;
  static const DefTable t = [] {
    TableOf<D> table("Plummer's sphere in equilibrium, the usual model of a star cluster");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies")
        .number("mass", &D::mass, "kg", above(0), "of all bodies together")
        .number("radius", &D::radius, "m", above(0), "Plummer's a: half the mass is within 1.305 of it")
        .number("cut", &D::cut, "1", above(1), "largest distance of a body, in radii");
    return add_place(table).build();
  }();
  return t;
}

const DefTable& sphere_table() {
  using D = SphereDef;
  static const DefTable t = [] {
    TableOf<D> table("a ball of uniform density; at rest it collapses");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies")
        .number("mass", &D::mass, "kg", above(0), "of all bodies together")
        .number("radius", &D::radius, "m", above(0), "of the ball")
        .number("virial_ratio", &D::virial_ratio, "1", between(0, 10),
                "twice the kinetic energy of random motion over the potential energy; 1: virial equilibrium");
    return add_place(table).build();
  }();
  return t;
}

const DefTable& galaxy_table() {
  using D = GalaxyDef;
  static const DefTable t = [] {
    TableOf<D> table("a rotating exponential disk, optionally with a central body and a halo");
    table.integer("count", &D::count, between(1, kMostBodies), "bodies of the disk")
        .number("mass", &D::mass, "kg", above(0), "of the disk")
        .number("scale_length", &D::scale_length, "m", above(0), "over which the density falls by a factor e")
        .number("height", &D::height, "m", at_least(0), "the density goes as 1/cosh^2 (z / height)")
        .number("dispersion", &D::dispersion, "1", between(0, 1), "random speeds over the circular speed")
        .number("central_mass", &D::central_mass, "kg", at_least(0), "of a central body; 0: none")
        .integer("halo_count", &D::halo_count, between(0, kMostBodies),
                 "bodies of a Plummer sphere around the disk")
        .number("halo_mass", &D::halo_mass, "kg", at_least(0), "of that sphere")
        .number("halo_radius", &D::halo_radius, "m", above(0), "Plummer's a")
        .vector("axis", &D::axis, "1", any(), "axis of the disk's rotation")
        .check([](const D& d, const DefTable::Report& report) {
          if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
          if ((d.halo_count > 0) != (d.halo_mass > 0)) {
            report("/halo_mass", "a halo needs both bodies (halo_count) and a mass");
          }
        });
    return add_place(table).build();
  }();
  return t;
}

const DefTable& ring_table() {
  using D = RingDef;
  static const DefTable t =
      TableOf<D>("bodies on circular orbits around another body")
          .integer("count", &D::count, between(1, kMostBodies), "bodies")
          .integer("around", &D::around, at_least(0), "row of the central body")
          .number("mass", &D::mass, "kg", at_least(0), "of all bodies together; 0: they attract nothing")
          .number("inner_radius", &D::inner_radius, "m", above(0), "of the smallest orbit")
          .number("outer_radius", &D::outer_radius, "m", above(0), "of the largest orbit")
          .number("thickness", &D::thickness, "m", at_least(0), "from the lowest to the highest")
          .number("body_radius", &D::body_radius, "m", at_least(0), "of a body")
          .vector("axis", &D::axis, "1", any(), "axis of the orbits")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
            if (!(d.outer_radius >= d.inner_radius))
              report("/outer_radius", "must be at least the inner radius");
          })
          .build();
  return t;
}

const DefTable& orbit_table() {
  using D = OrbitDef;
  static const DefTable t =
      TableOf<D>("a body on a Kepler ellipse around another, given by orbital elements")
          .integer("around", &D::around, at_least(0), "row of the body at the focus")
          .number("mass", &D::mass, "kg", at_least(0), "its mass")
          .number("radius", &D::radius, "m", at_least(0), "its radius")
          .number("semi_major_axis", &D::semi_major_axis, "m", above(0), "half the longer axis")
          .number("eccentricity", &D::eccentricity, "1", between(0, 0.999), "0: a circle")
          .number("inclination", &D::inclination, "rad", any(), "to the x-y plane")
          .number("ascending_node", &D::ascending_node, "rad", any(),
                  "from x to where the orbit rises through the plane")
          .number("periapsis", &D::periapsis, "rad", any(),
                  "argument of periapsis: from the node to the nearest point")
          .number("mean_anomaly", &D::mean_anomaly, "rad", any(), "at t = 0")
          .build();
  return t;
}

const DefTable& collisions_table() {
  using D = CollisionsDef;
  static const DefTable t =
      TableOf<D>("response of bodies whose spheres touch")
          .choice("response", &D::response, {"merge", "bounce", "stop"},
                  "merge into one body, bounce, or lose the relative velocity")
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
                         : "a body before this group: 0 to " + std::to_string(before - 1));
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
                 "one per position; 0: attracts nothing; absent: the system's mass")
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
                  {0, 10'000}, "generated bodies; rows count through positions, then groups in their order")
        .choice("softening_kind", &D::softening_kind, {"plummer", "spline"},
                "how attraction weakens near a body: Plummer, at all distances, or spline, within 2.8 "
                "softenings only")
        .number("softening", &D::softening, "m", at_least(0), "length below which attraction weakens")
        .choice("method", &D::method, {"auto", "direct", "mixed", "tree", "fmm"},
                "all pairs, exact; all pairs, most in single precision, error about 1e-7; a tree, for many "
                "bodies; the fast multipole method, for very many; auto: the fastest for force_error")
        .number("force_error", &D::force_error, "1", between(1e-6, 0.05),
                "of tree and fmm: relative error of the acceleration, root mean square over the bodies")
        .object("collisions", &D::collisions, collisions_table(), "absent: bodies pass through each other")
        .number("draw_radius", &D::draw_radius, "m", at_least(0),
                "size in pictures; absent: from the scene's size")
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
  // These make one group of the tree, whose pairs are summed one by one in any case.
  if (n <= gravity::BodyTree::kMostInGroup) return Method::direct;
  if (d.method != Method::automatic) return d.method;
  if (d.integrator == "ias15") return Method::direct;
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
