#include "engine/systems/sph/sph_def.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/systems/sph/inlet.h"
#include "engine/systems/sph/mesh_wall.h"

namespace truestep::sph {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMostParticles = 1e7, kMostCells = 1e8;

const DefTable& body_table() {
  using D = BodyDef;
  static const DefTable t =
      TableOf<D>("fluid at the start")
          .choice("shape", &D::shape, {"box", "ball"}, "region to fill")
          .vector("center", &D::center, "m", any(), "of the shape")
          .vector("half_extents", &D::half_extents, "m", above(0), "of a box")
          .number("radius", &D::radius, "m", above(0), "of a ball")
          .vector("velocity", &D::velocity, "m/s", any(), "initial, of its centre")
          .vector("spin", &D::spin, "rad/s", any(), "initial, about its centre")
          .vector("strain", &D::strain, "1/s", any(),
                  "initial: along each axis, velocity per distance from the centre")
          .number("density", &D::density, "kg/m^3", above(0), "at rest; absent: the system's density")
          .build();
  return t;
}

const DefTable& hollow_table() {
  using D = HollowDef;
  static const DefTable t = TableOf<D>("a region without fluid")
                                .choice("shape", &D::shape, {"box", "ball"}, "shape of the region")
                                .vector("center", &D::center, "m", any(), "of the shape")
                                .vector("half_extents", &D::half_extents, "m", above(0), "of a box")
                                .number("radius", &D::radius, "m", above(0), "of a ball")
                                .build();
  return t;
}

const DefTable& inlet_table() {
  using D = InletDef;
  static const DefTable t = [] {
    TableOf<D> table(
        "a nozzle: a disk, or in the plane a line, that emits liquid in layers one spacing apart");
    return add_source_rows(table)
        .number("density", &D::density, "kg/m^3", above(0), "at rest; absent: the system's density")
        .check([](const D& d, const DefTable::Report& report) {
          check_source(d, report);
          if (!(d.speed > 0)) report("/speed", "a nozzle needs a speed above 0");
        })
        .build();
  }();
  return t;
}

Vec3 reach_of(const BodyDef& b) {
  return b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
}

/// Points along each axis of the lattice that fills a body; 1 across the plane. The lattice is no denser than
/// the liquid, or the liquid would burst: each axis gets the nearest whole number of points, and while that
/// makes the lattice too dense, one point is removed along the axis where they are closest together (of a
/// ball, one along every axis).
std::array<double, 3> lattice_of(const SphDef& d, const BodyDef& b) {
  constexpr double kRounding = 1e-9;
  const size_t axes = d.dimension == 2 ? 2 : 3;
  const Vec3 reach = reach_of(b);
  const double wide[3] = {2 * reach.x / d.spacing, 2 * reach.y / d.spacing, 2 * reach.z / d.spacing};
  std::array<double, 3> out{1, 1, 1};
  double per_point = 1;  // volume, in spacings
  for (size_t a = 0; a < axes; ++a) {
    out[a] = std::max(1.0, std::floor(wide[a] + 0.5));
    per_point *= wide[a] / out[a];
  }
  while (per_point < 1 - kRounding) {
    size_t closest = axes;
    for (size_t a = 0; a < axes; ++a) {
      const bool close = out[a] > 1 && wide[a] < out[a] * (1 - kRounding);
      if (close && (closest == axes || wide[a] / out[a] < wide[closest] / out[closest])) closest = a;
    }
    if (closest == axes) break;  // thinner than a spacing
    for (size_t a = 0; a < axes; ++a) {
      if (a == closest || b.shape == Shape::ball) per_point *= out[a] / (out[a] - 1), out[a] -= 1;
    }
  }
  return out;
}

void check_body(const SphDef& d, const BodyDef& b, const std::string& at, const DefTable::Report& report) {
  const bool plane = d.dimension == 2;
  const Vec3 reach = reach_of(b);
  Vec3 from = b.center - reach - d.low, to = d.high - b.center - reach;
  if (plane) from.z = to.z = 0;
  const bool inside = std::min({from.x, from.y, from.z, to.x, to.y, to.z}) >= -1e-9 * norm(d.high - d.low);
  if (!inside) report(at, "reaches out of the box from low to high");
  if (plane && (b.velocity.z != 0 || b.spin.x != 0 || b.spin.y != 0 || b.strain.z != 0)) {
    report(at + (b.velocity.z != 0 ? "/velocity"
                 : b.strain.z != 0 ? "/strain"
                                   : "/spin"),
           "a plane body must move in the plane z = 0");
  }
  if (inside && places_of(d, b).empty()) report(at, "is too small for a single particle");
}

/// The nozzle and the region behind it must lie in the box.
void check_inlet(const SphDef& d, const InletDef& def, const std::string& at,
                 const DefTable::Report& report) {
  const bool plane = d.dimension == 2;
  if (plane && def.direction.z != 0) return report(at + "/direction", "a plane system moves in z = 0");
  if (def.radius > std::sqrt(kMostParticles / kPi) * d.spacing) {
    return report(at + "/radius", "more than ten million particles in a layer");
  }
  const Inlet inlet(d, def);
  if (inlet.places.empty()) return report(at + "/radius", "is too small for a single particle");
  const double gap = 0.5 * d.spacing;
  const auto inside = [&](const Vec3& p) {
    const Vec3 from = p - d.low, to = d.high - p;
    return std::min({from.x, from.y, to.x, to.y}) >= gap && (plane || std::min(from.z, to.z) >= gap);
  };
  for (const Vec3& p : inlet.places) {
    if (inside(inlet.mouth + p) && inside(inlet.back() + p)) continue;
    return report(at + "/position",
                  "the nozzle, one kernel radius deep behind its position, must lie in the box");
  }
}

void check_density(double ratio, const std::string& at, const DefTable::Report& report) {
  if (ratio < 0.001 || ratio > 1000) report(at, "must be within 0.001 to 1000 times the system's density");
}

void check_def(const SphDef& d, const DefTable::Report& report) {
  const Vec3 size = d.high - d.low;
  const bool plane = d.dimension == 2;
  const double reach = d.support * d.spacing;
  const double least = plane ? std::min(size.x, size.y) : std::min({size.x, size.y, size.z});
  // With a wider support the density summed by this pair is not the one that its slopes correct, and the
  // solve shakes the water.
  if (d.kernel == Smoothing::poly6_spiky && d.solver == Method::dfsph && d.support > 2) {
    report("/support",
           "at most 2 for poly6_spiky with dfsph: with a wider kernel its slopes do not correct its density");
  }
  if (!(least >= 3 * reach)) {
    return report("/high", "the box must be at least three kernel radii (3 x support x spacing) wide");
  }
  const double cells = size.x * size.y * (plane ? 1 : size.z) / (reach * reach * (plane ? 1 : reach));
  if (cells > kMostCells) return report("/spacing", "more than 1e8 cells of one kernel radius");
  if (expected_particles(d) > kMostParticles) return report("/bodies", "more than ten million particles");
  if (plane && d.wraps(2)) return report("/periodic", "a plane system has no direction z");
  if (plane && d.lid_velocity.z != 0) return report("/lid_velocity", "a plane system moves in z = 0");
  if (d.lid_velocity.y != 0) return report("/lid_velocity", "the lid slides: y must be 0");
  if (d.wraps(1) && norm2(d.lid_velocity) > 0)
    return report("/lid_velocity", "a box that is periodic along y has no upper side");
  if (!d.initial.empty() && d.initial.size() != static_cast<size_t>(d.dimension))
    return report("/initial", "needs as many components as `dimension`");
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    const std::string at = "/bodies/" + std::to_string(k);
    check_body(d, d.bodies[k], at, report);
    check_density(d.bodies[k].density.value_or(d.density) / d.density, at + "/density", report);
  }
  for (size_t k = 0; k < d.emitters.size(); ++k) {
    const std::string at = "/emitters/" + std::to_string(k);
    check_inlet(d, d.emitters[k], at, report);
    check_density(d.emitters[k].density.value_or(d.density) / d.density, at + "/density", report);
  }
  check_mesh_walls(d, report);
  if (d.bodies.empty() && d.emitters.empty())
    report("/bodies", "no bodies and no emitters: nothing to simulate");
  if (d.max_particles && static_cast<double>(*d.max_particles) < expected_particles(d)) {
    report("/max_particles", "fewer than the particles at t = 0");
  }
}

}  // namespace

bool SphDef::layered() const {
  const SphDef d = with_common_density();
  const auto other = [&](const auto& b) { return b.density && *b.density != d.density; };
  return std::any_of(d.bodies.begin(), d.bodies.end(), other) ||
         std::any_of(d.emitters.begin(), d.emitters.end(), other);
}

SphDef SphDef::with_common_density() const {
  SphDef out = *this;
  if (!bodies.empty()) {
    out.density = bodies[0].density.value_or(density);
  } else if (!emitters.empty()) {
    out.density = emitters[0].density.value_or(density);
  }
  const auto same = [&](const auto& b) { return b.density.value_or(density) == out.density; };
  const bool common =
      std::all_of(bodies.begin(), bodies.end(), same) && std::all_of(emitters.begin(), emitters.end(), same);
  if (!common) return *this;
  for (BodyDef& b : out.bodies) b.density.reset();
  for (InletDef& e : out.emitters) e.density.reset();
  return out;
}

size_t largest_count(const SphDef& d, size_t start) {
  if (d.max_particles) return std::max(static_cast<size_t>(*d.max_particles), start);
  double n = static_cast<double>(start);
  for (const InletDef& e : d.emitters) n += Inlet(d, e).most();
  // The emitters' total is unbounded or too large: a default that the scene can raise.
  return n <= kMostParticles ? static_cast<size_t>(n) : std::max<size_t>(start, 100'000);
}

bool HollowDef::contains(const Vec3& p) const {
  const Vec3 from = p - center, e = half_extents;
  if (shape == Shape::ball) return norm2(from) < radius * radius;
  return std::abs(from.x) < e.x && std::abs(from.y) < e.y && std::abs(from.z) < e.z;
}

Collider HollowDef::solid() const {
  Collider out = common_collider({});
  out.shape.kind = shape == Shape::ball ? ShapeKind::sphere : ShapeKind::box;
  out.shape.size = shape == Shape::ball ? Vec3{radius, 0, 0} : half_extents;
  out.start.position = center;
  return out;
}

std::vector<Vec3> places_of(const SphDef& d, const BodyDef& b) {
  // A lattice aligned with the shape, its points half a spacing from the faces of a box.
  const Vec3 reach = reach_of(b);
  const double r[3] = {reach.x, reach.y, reach.z};
  const std::array<double, 3> count = lattice_of(d, b);
  std::vector<Vec3> out;
  for (int64_t i = 0; i < static_cast<int64_t>(count[0]); ++i) {
    for (int64_t j = 0; j < static_cast<int64_t>(count[1]); ++j) {
      for (int64_t k = 0; k < static_cast<int64_t>(count[2]); ++k) {
        const auto at = [&](size_t a, int64_t m) {
          return (static_cast<double>(m) + 0.5) * 2 * r[a] / count[a] - r[a];
        };
        const Vec3 x{at(0, i), at(1, j), d.dimension == 3 ? at(2, k) : 0};
        if (b.shape == Shape::ball && norm2(x) > b.radius * b.radius) continue;
        Vec3 place = b.center + x;
        if (d.dimension == 2) place.z = 0;
        const auto leaves_out = [&](const HollowDef& h) { return h.contains(place); };
        if (std::none_of(d.hollows.begin(), d.hollows.end(), leaves_out)) out.push_back(place);
      }
    }
  }
  return out;
}

double expected_particles(const SphDef& d) {
  double sum = 0;
  for (const BodyDef& b : d.bodies) {
    const std::array<double, 3> n = lattice_of(d, b);
    const double share = b.shape == Shape::box ? 1 : d.dimension == 2 ? kPi / 4 : kPi / 6;
    sum += n[0] * n[1] * n[2] * share;
  }
  return sum;
}

const DefTable& sph_table() {
  static const DefTable t = [] {
    using D = SphDef;
    TableOf<D> table("a liquid of particles (smoothed particle hydrodynamics)");
    table.integer("dimension", &D::dimension, between(2, 3), "2: in z = 0, one metre thick; 3: space")
        .vector("low", &D::low, "m", any(), "corner of the box that contains everything")
        .vector("high", &D::high, "m", any(), "opposite corner; z is ignored in the plane")
        .number("spacing", &D::spacing, "m", above(0), "between particles at rest")
        .objects("bodies", &D::bodies, body_table(), {0, 1000}, "fluid at the start")
        .texts("initial", &D::initial, {0, 3},
               "m/s, initial velocity, added to that of the bodies: expressions of x, y and z")
        .objects("hollows", &D::hollows, hollow_table(), {0, 1000},
                 "regions without fluid at the start, even inside bodies of fluid: room for immersed bodies")
        .number(
            "settle", &D::settle, "s", between(0, 1000),
            "for which all liquid that does not move at the start settles before time starts, between walls "
            "that stand and around solid hollows; 20 lets a pool start still, 0 starts on a lattice")
        .objects("emitters", &D::emitters, inlet_table(), {0, 64}, "nozzles")
        .integer("max_particles", &D::max_particles, between(1, kMostParticles),
                 "most particles at once; absent: enough for the emitters, 100,000 if they never end")
        .choice("solver", &D::solver, {"dfsph", "wcsph", "pbf"},
                "dfsph: pressure solved for constant density and zero divergence; wcsph: pressure from "
                "density by Tait's equation; pbf: positions corrected to constant density")
        .choice("kernel", &D::kernel, {"cubic", "wendland_c2", "wendland_c4", "poly6_spiky"},
                "smoothing kernel; poly6_spiky: poly6 for density, spiky for pressure")
        .number("support", &D::support, "1", between(1.5, 4), "radius of the kernel in spacings")
        .number("density", &D::density, "kg/m^3", above(0), "at rest")
        .number("viscosity", &D::viscosity, "m^2/s", at_least(0), "kinematic")
        .choice("viscosity_step", &D::viscosity_step, {"explicit", "implicit", "weiler2018"},
                "explicit: substeps short enough for `viscosity`; implicit: the same forces, solved for in "
                "substeps of any length; weiler2018: a solve that conserves angular momentum, for thick "
                "liquids with a free surface")
        .number("surface_tension", &D::surface_tension, "N/m", at_least(0), "at free surfaces")
        .choice("surface_tension_model", &D::surface_tension_model, {"cohesion", "interface"},
                "cohesion: pairs attract each other (Akinci et al. 2013); interface: forces from the "
                "gradient of a surface energy")
        .number("artificial_viscosity", &D::artificial_viscosity, "1", between(0, 1),
                "Monaghan's alpha, of solver wcsph")
        .number("xsph", &D::xsph, "1", between(0, 1),
                "fraction of the neighbours' mean velocity mixed into a particle's own every 1/60 s: a "
                "viscosity that keeps particles in order; use 0 if `viscosity` is resolved")
        .number("vorticity", &D::vorticity, "1", between(0, 10), "strength of vorticity confinement")
        .number(
            "shifting", &D::shifting, "1", between(0, 4),
            "strength of particle shifting, from where particles are dense to where they are sparse: for "
            "flows inside a liquid, which gather particles along streamlines; absent: 2 in a full box that "
            "is periodic along every axis, else 0")
        .number("density_error", &D::density_error, "1", {.min = 1e-6, .max = 0.1},
                "mean compression per substep at which a solve of dfsph ends, less where the liquid hardly "
                "moves (down to "
                "a tenth); the largest may be ten times this")
        .integer("max_iterations", &D::max_iterations, between(2, 10'000), "of each solve of dfsph")
        .number(
            "sound_speed", &D::sound_speed, "m/s", at_least(0),
            "of wcsph, in liquid of this density; 0: ten times the largest speed that the start, emitters, "
            "moving colliders and the fall from there can lead to, and as much more for denser liquids "
            "as their compression needs")
        .number("density_diffusion", &D::density_diffusion, "1", between(0, 0.5),
                "delta of delta-SPH, of solver wcsph")
        .integer("pbf_iterations", &D::pbf_iterations, between(1, 1000), "per substep, of solver pbf")
        .number("artificial_pressure", &D::artificial_pressure, "1", between(0, 1),
                "of solver pbf, between particles that come too close, in units of relative density: keeps "
                "drops apart "
                "in pictures (0.05), but shortens the periods of waves by 5 %")
        .number("courant", &D::courant, "1", {.min = 0.01, .max = 0.8},
                "spacings that a particle, or with wcsph a sound wave, may cross per substep")
        .integer("max_substeps", &D::max_substeps, between(1, 1e6), "of a step; a step that needs more fails")
        .choice("walls", &D::walls, {"slip", "no_slip"},
                "no_slip: the box and colliders drag viscous fluid along")
        .vector("lid_velocity", &D::lid_velocity, "m/s", any(), "of the upper side in y, parallel to it")
        .choice(
            "periodic", &D::periodic, {"none", "x", "y", "xy", "z", "xz", "yz", "xyz"},
            "directions in which fluid that leaves the box re-enters at the other side, where what reaches "
            "through this one acts too");
    // The rest is common to all systems of points.
    add_kill_rows(table);
    add_collider_rows(table, &D::colliders);
    table.choice("precision", &D::precision, {"f32", "f64"}, "of the particles");
    return table.check(check_def).build();
  }();
  return t;
}

const Resolution& sph_resolution() {
  static const Resolution kSpacing{.parameter = "spacing",
                                   .divide = [](void* def, double factor) -> std::optional<std::string> {
                                     auto& d = *static_cast<SphDef*>(def);
                                     d.spacing /= factor;
                                     std::optional<std::string> why;
                                     check_def(d,
                                               [&](const std::string& pointer, const std::string& message) {
                                                 if (!why) why = pointer + ": " + message;
                                               });
                                     return why;
                                   },
                                   .order = [](const void*) { return 0; }};
  return kSpacing;
}

double expected_neighbours(const SphDef& d) {
  const double s = d.support;
  return (d.dimension == 2 ? kPi * s * s : 4 * kPi / 3 * s * s * s) + 4;
}

namespace {

// m, of the highest body that the liquid starts as.
double filled_height(const SphDef& d) {
  double most = 0;
  for (const BodyDef& b : d.bodies)
    most = std::max(most, 2 * (b.shape == Shape::box ? b.half_extents.y : b.radius));
  return most;
}

}  // namespace

double sph_step_seconds(const SphDef& d, double h, double speed, double sound, double gravity) {
  const double n = static_cast<double>(largest_count(d, static_cast<size_t>(expected_particles(d))));
  const double pairs = n * expected_neighbours(d), reach = d.courant * d.spacing;
  const double fastest = d.solver == Method::wcsph ? speed + sound : speed;
  double allowed = fastest > 0 ? reach / fastest : HUGE_VAL;
  if (d.solver != Method::wcsph && gravity > 0) {
    // Of the time in which a particle falls half a spacing, and of position-based pressure, which carries so
    // many layers an iteration: the shares are those of solvers/allowed.h.
    constexpr double kFall = 0.09, kCarried = 0.09;
    allowed = std::min(allowed, kFall * std::sqrt(d.spacing / gravity));
    const double deep = std::max(filled_height(d), d.spacing);
    if (d.solver == Method::pbf)
      allowed = std::min(allowed, d.spacing * std::sqrt(kCarried * static_cast<double>(d.pbf_iterations) /
                                                        (gravity * deep)));
  }
  const double substeps = std::max(1.0, h / allowed), passes = d.solver == Method::wcsph ? 3 : 30;
  return substeps * pairs * (4e-9 + passes * 0.7e-9);
}

Cost sph_cost(const void* def) {
  const auto& d = *static_cast<const SphDef*>(def);
  const double n = static_cast<double>(largest_count(d, static_cast<size_t>(expected_particles(d)))),
               scalar = d.precision == Precision::f32 ? 4 : 8;
  const bool plane = d.dimension == 2;
  // Lists with room to grow: a slot, a gradient (for floats 16 bits), a slope and a weight.
  const double pairs = n * expected_neighbours(d);
  const Vec3 size = d.high - d.low;
  const double reach = d.support * d.spacing;
  const double cells = size.x * size.y * (plane ? 1 : size.z) / (reach * reach * (plane ? 1 : reach));
  return {.state_bytes = n * scalar * (d.settle > 0 ? 20 : 10),
          .workspace_bytes = pairs * 1.5 * (d.precision == Precision::f32 ? 17 : 50) +
                             n * scalar *
                                 ((d.solves_viscosity() ? 67 : 42) +
                                  (d.shifting.value_or(d.without_sides() ? 2 : 0) > 0 ? 5 : 0)) +
                             cells * 4 + n * 4 + bytes_of_mesh_walls(d),
          .elements = n,
          // Until the length of a step is known (System::limit): water that falls as far as it is deep.
          .seconds_per_step = sph_step_seconds(d, 1.0 / 60, 2, 20, 9.81),
          .settles = d.settle};
}

}  // namespace truestep::sph
