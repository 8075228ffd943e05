#include "engine/systems/mpm/mpm_def.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/kernels/mpm/stiffness.h"
#include "engine/math/trig.h"
#include "engine/systems/mpm/blocks.h"
#include "engine/systems/mpm/inlet.h"

namespace truestep::mpm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMostParticles = 1e7, kMostCells = 1e8;
constexpr int kMostFields = 16;

/// The rows of a def that is one.
template <class D>
TableOf<D>& add_material_rows(TableOf<D>& table) {
  Law D::*material = &MaterialDef::material;
  std::string D::*energy = &MaterialDef::energy;
  const auto number = [](double MaterialDef::*m) { return static_cast<double D::*>(m); };
  using M = MaterialDef;
  return table
      .choice("material", material, {"fluid", "corotated", "neo_hookean", "snow", "sand", "foam", "elastic"},
              "how its stress follows from its deformation")
      .text(
          "energy", energy,
          "J/m^3, of elastic: an expression of the singular values s1, s2 (s3) of the deformation gradient, "
          "of I1, I2 and J, mu and lambda")
      .number("density", number(&M::density), "kg/m^3", above(0), "at rest")
      .number("youngs_modulus", number(&M::youngs_modulus), "Pa", above(0), "of everything but a fluid")
      .number("poisson_ratio", number(&M::poisson_ratio), "1", {.min = -0.99, .max = 0.495},
              "of everything but a fluid")
      .number("bulk_modulus", number(&M::bulk_modulus), "Pa", above(0),
              "of a fluid: pressure per relative change of volume; its waves run at sqrt(K / density)")
      .number("hardening", number(&M::hardening), "1", between(0, 30), "xi of snow")
      .number("critical_compression", number(&M::critical_compression), "1", between(0, 0.5),
              "theta_c of snow")
      .number("critical_stretch", number(&M::critical_stretch), "1", between(0, 0.5), "theta_s of snow")
      .number("friction_angle", number(&M::friction_angle), "rad", between(0, 1.4), "of sand")
      .number("yield_stress", number(&M::yield_stress), "Pa", above(0), "of foam, in tension (von Mises)")
      .integer("velocity_field", static_cast<int D::*>(&M::velocity_field), between(0, kMostFields - 1),
               "number of its velocity field: bodies of the same number stick where they share nodes; bodies "
               "of different numbers touch at their surfaces, separate and slide with field_friction");
}

const DefTable& body_table() {
  using D = BodyDef;
  static const DefTable t = [] {
    TableOf<D> table("a piece of one material");
    table.choice("shape", &D::shape, {"box", "ball"}, "region to fill")
        .vector("center", &D::center, "m", any(), "of the shape")
        .vector("half_extents", &D::half_extents, "m", above(0), "of a box")
        .number("radius", &D::radius, "m", above(0), "of a ball")
        .number("inner_radius", &D::inner_radius, "m", at_least(0), "of a hollow ball")
        .vector("velocity", &D::velocity, "m/s", any(), "initial, of its centre")
        .vector("spin", &D::spin, "rad/s", any(), "initial, about its centre");
    return add_material_rows(table).build();
  }();
  return t;
}

const DefTable& inlet_table() {
  static const DefTable t = [] {
    TableOf<InletDef> table("a nozzle: a disk, or in the plane a line, that emits material in layers");
    return add_material_rows(add_source_rows(table))
        .check([](const InletDef& d, const DefTable::Report& report) {
          check_source(d, report);
          if (!(d.speed > 0)) report("/speed", "a nozzle needs a speed above 0");
        })
        .build();
  }();
  return t;
}

/// Checks that the nozzle and what is behind it lie in the box.
void check_inlet(const MpmDef& d, const InletDef& def, const std::string& at,
                 const DefTable::Report& report) {
  if (d.dimension == 2 && def.direction.z != 0)
    return report(at + "/direction", "a plane material moves in z = 0");
  if (def.radius > std::sqrt(kMostParticles / kPi) * d.spacing())
    return report(at + "/radius", "more than ten million particles in a layer");
  const Inlet inlet(d, def);
  if (inlet.places.empty()) return report(at + "/radius", "is too small for a single particle");
  const auto inside = [&](const Vec3& p) {
    const Vec3 from = p - d.low, to = d.high - p;
    const double least = std::min({from.x, from.y, to.x, to.y});
    return least >= 0 && (d.dimension == 2 || std::min(from.z, to.z) >= 0);
  };
  for (const Vec3& p : inlet.places) {
    if (inside(inlet.mouth + p) && inside(inlet.back() + p)) continue;
    return report(at + "/position", "the nozzle, two cells deep behind its position, must lie in the box");
  }
}

void check_material(const MpmDef& d, const MaterialDef& m, const std::string& at,
                    const DefTable::Report& report) {
  if (d.is_implicit() && !has_stiffness(m.material))
    report(at + "/material",
           "the implicit step takes only corotated and neo_hookean: use explicit for others");
  if (d.is_implicit() && m.velocity_field != velocity_fields(d).front())
    report(at + "/velocity_field", "the implicit step has a single velocity field: use explicit for several");
  if (m.material == Law::elastic && m.energy.empty())
    report(at + "/energy",
           "material elastic needs an energy, as \"mu/2*(I1-3)-mu*log(J)+lambda/2*log(J)^2\"");
  if (m.material != Law::elastic && !m.energy.empty()) report(at + "/energy", "only for material elastic");
}

/// Points along every axis of the lattice that fills a body; 1 across the plane.
std::array<double, 3> lattice_of(const MpmDef& d, const BodyDef& b) {
  const double target = d.cell / d.particles_per_axis;
  const Vec3 reach = b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
  const auto places = [&](double r) { return std::max(1.0, std::floor(2 * r / target + 0.5)); };
  return {places(reach.x), places(reach.y), d.dimension == 2 ? 1 : places(reach.z)};
}

double cells_of(const MpmDef& d) {
  const Vec3 size = (d.high - d.low) / d.cell;
  return size.x * size.y * (d.dimension == 2 ? 1 : size.z);
}

void check_def(const MpmDef& d, const DefTable::Report& report) {
  const Vec3 size = d.high - d.low;
  const bool plane = d.dimension == 2;
  const double least = plane ? std::min(size.x, size.y) : std::min({size.x, size.y, size.z});
  const auto components = [&](const std::vector<std::string>& texts, const char* pointer) {
    if (!texts.empty() && texts.size() != static_cast<size_t>(d.dimension))
      report(pointer, "needs as many components as there are dimensions");
  };
  components(d.force, "/force"), components(d.exact, "/exact");
  if (!(least >= 4 * d.cell)) return report("/high", "the box must be at least four cells wide");
  if (cells_of(d) > kMostCells) return report("/cell", "more than 1e8 cells");
  if (expected_particles(d) > kMostParticles) return report("/bodies", "more than ten million particles");
  for (size_t k = 0; k < d.emitters.size(); ++k) {
    const std::string at = "/emitters/" + std::to_string(k);
    check_inlet(d, d.emitters[k], at, report), check_material(d, d.emitters[k], at, report);
  }
  if (d.bodies.empty() && d.emitters.empty())
    report("/bodies", "no bodies and no emitters: nothing to simulate");
  if (d.max_particles && static_cast<double>(*d.max_particles) < expected_particles(d))
    report("/max_particles", "fewer than the particles at t = 0");
  if (d.is_implicit() && d.precision == Precision::f32)
    report("/precision", "the implicit step needs f64: single precision is too coarse for stiff material");
  if (d.changes() && !d.exact.empty())
    report("/exact", "exact positions need a fixed set of particles: no emitters, no kill regions");
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    const BodyDef& b = d.bodies[k];
    const std::string at = "/bodies/" + std::to_string(k);
    check_material(d, b, at, report);
    Vec3 reach = b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
    Vec3 from = b.center - reach - d.low, to = d.high - b.center - reach;
    if (plane) from.z = to.z = 0;
    const double slack = -1e-9 * least;
    const bool inside = std::min({from.x, from.y, from.z, to.x, to.y, to.z}) >= slack;
    if (!inside) report(at, "reaches out of the box from low to high");
    if (plane && (b.velocity.z != 0 || b.spin.x != 0 || b.spin.y != 0)) {
      report(at + (b.velocity.z != 0 ? "/velocity" : "/spin"), "a plane body must move in the plane z = 0");
    }
    if (b.shape == Shape::ball && b.inner_radius >= b.radius) {
      report(at + "/inner_radius", "must be less than the radius");
    } else if (inside && places_of(d, b).empty())
      report(at, "is too small for a single particle");
  }
}

}  // namespace

Material material_of(const MaterialDef& b) {
  Material m;
  m.law = b.material;
  const double e = b.youngs_modulus, nu = b.poisson_ratio;
  m.mu = e / (2 * (1 + nu)), m.lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
  if (m.law == Law::fluid) m.mu = 0, m.lambda = b.bulk_modulus;
  m.hardening = b.hardening, m.compression = b.critical_compression, m.stretch = b.critical_stretch;
  const double s = trig::sin(b.friction_angle);
  m.cone = std::sqrt(2.0 / 3) * 2 * s / (3 - s);
  m.yield = b.yield_stress;
  return m;
}

std::vector<int> velocity_fields(const MpmDef& d) {
  std::vector<int> out;
  for (const BodyDef& b : d.bodies) out.push_back(b.velocity_field);
  for (const InletDef& e : d.emitters) out.push_back(e.velocity_field);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Vec3 spacing_of(const MpmDef& d, const BodyDef& b) {
  const Vec3 reach = b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
  const std::array<double, 3> count = lattice_of(d, b);
  return {2 * reach.x / count[0], 2 * reach.y / count[1], 2 * reach.z / count[2]};
}

std::vector<Vec3> places_of(const MpmDef& d, const BodyDef& b) {
  // A lattice aligned with the shape, its outer points half a spacing from the faces of a box.
  const Vec3 reach = b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
  const double r[3] = {reach.x, reach.y, reach.z};
  const std::array<double, 3> count = lattice_of(d, b);
  int64_t n[3];
  double step[3];
  for (size_t a = 0; a < 3; ++a) n[a] = static_cast<int64_t>(count[a]), step[a] = 2 * r[a] / count[a];
  std::vector<Vec3> out;
  for (int64_t i = 0; i < n[0]; ++i) {
    for (int64_t j = 0; j < n[1]; ++j) {
      for (int64_t k = 0; k < n[2]; ++k) {
        const auto at = [&](int a, int64_t m) {
          return a < d.dimension ? (static_cast<double>(m) + 0.5) * step[a] - r[a] : 0.0;
        };
        const Vec3 x{at(0, i), at(1, j), at(2, k)};
        if (b.shape == Shape::ball &&
            (norm2(x) > b.radius * b.radius || norm2(x) < b.inner_radius * b.inner_radius))
          continue;
        Vec3 place = b.center + x;
        if (d.dimension == 2) place.z = 0;
        out.push_back(place);
      }
    }
  }
  return out;
}

double expected_particles(const MpmDef& d) {
  double sum = 0;
  for (const BodyDef& b : d.bodies) {
    const std::array<double, 3> n = lattice_of(d, b);
    const double inner = b.inner_radius / b.radius, plane = (1 - inner * inner) * kPi / 4;
    const double share = b.shape == Shape::box ? 1
                         : d.dimension == 2    ? plane
                                               : (1 - inner * inner * inner) * kPi / 6;
    sum += n[0] * n[1] * n[2] * share;
  }
  return sum;
}

size_t largest_count(const MpmDef& d, size_t start) {
  if (!d.changes()) return start;
  if (d.max_particles) return std::max(static_cast<size_t>(*d.max_particles), start);
  double n = static_cast<double>(start);
  for (const InletDef& e : d.emitters) n += Inlet(d, e).most();
  // For unlimited emission: a default that the scene can raise.
  return n <= kMostParticles ? static_cast<size_t>(n) : std::max<size_t>(start, 100'000);
}

double expected_blocks(const MpmDef& d, double n) {
  const double axis = d.particles_per_axis, per_cell = axis * axis * (d.dimension == 2 ? 1 : axis);
  return 1.2 * n / (64 * per_cell) + 4;
}

const DefTable& mpm_table() {
  static const DefTable t = [] {
    using D = MpmDef;
    TableOf<D> table("snow, sand, water, jelly and foam by the material point method");
    const std::vector<std::string> kinds = {"sticky", "slip", "separate"};
    table
        .integer("dimension", &D::dimension, between(2, 3),
                 "2: plane strain in z = 0, one metre thick; 3: space")
        .vector("low", &D::low, "m", any(), "corner of the box that contains everything")
        .vector("high", &D::high, "m", any(), "opposite corner; z is ignored in the plane")
        .number("cell", &D::cell, "m", above(0), "width of the grid's cells")
        .integer("particles_per_axis", &D::particles_per_axis, between(1, 8),
                 "particles per cell along each axis: 2 gives 4 in the plane, 8 in space")
        .objects("bodies", &D::bodies, body_table(), {0, 1000}, "bodies at the start")
        .objects("emitters", &D::emitters, inlet_table(), {0, 64}, "nozzles")
        .integer("max_particles", &D::max_particles, between(1, kMostParticles),
                 "most particles at once; absent: enough for the emitters, 100,000 if they never end")
        .choice("splines", &D::splines, {"quadratic", "cubic"}, "kernel between particles and grid")
        .choice("transfer", &D::transfer, {"apic", "flip"},
                "velocity that particles keep from step to step: an affine field from the grid (apic, which "
                "conserves momentum and angular momentum) or their own plus the grid's change (flip)")
        .number("flip", &D::flip, "1", between(0, 1), "of transfer flip: 1 is FLIP, 0 is PIC")
        .choice("integration", &D::integration, {"explicit", "implicit"},
                "explicit: substeps as short as waves require; implicit: backward Euler for stiff corotated "
                "and neo_hookean solids, whose waves may cross any number of cells (precision f64)")
        .number("courant", &D::courant, "1", {.min = 0.01, .max = 0.8},
                "cells that a particle, and in the explicit step a wave, may cross per substep")
        .integer("max_substeps", &D::max_substeps, between(1, 1e6), "of a step; a step that needs more fails")
        .choice("walls", &D::walls, kinds, "boundary condition at the sides of the box")
        .choice("floor", &D::floor, {"sticky", "slip", "separate", "as_walls"},
                "the same for the lower side in y")
        .number("wall_friction", &D::wall_friction, "1", at_least(0),
                "Coulomb's coefficient of walls that separate")
        .choice("contact", &D::contact, kinds,
                "boundary condition at colliders and immersed bodies; friction is each collider's own")
        .number("body_friction", &D::body_friction, "1", at_least(0),
                "Coulomb's coefficient of bodies in the material (coupling immersion)")
        .number("field_friction", &D::field_friction, "1", at_least(0),
                "Coulomb's coefficient between bodies whose velocity_field differs")
        .texts("force", &D::force, {0, 3}, "m/s^2, acceleration: expressions of x, y, z and t")
        .texts("exact", &D::exact, {0, 3},
               "m, exact position at t of a particle that starts at x, y, z: expressions; observed as "
               "error.exact")
        .choice("precision", &D::precision, {"f32", "f64"}, "of particles and grid");
    add_kill_rows(table);
    add_collider_rows(table, &D::colliders);
    return table.check(check_def).build();
  }();
  return t;
}

const Resolution& mpm_resolution() {
  // Particles follow the cells: the same number per cell at every resolution.
  static const Resolution kCell{
      .parameter = "cell",
      .divide = [](void* def, double factor) -> std::optional<std::string> {
        auto& d = *static_cast<MpmDef*>(def);
        d.cell /= factor;
        if (cells_of(d) > kMostCells) return "more than 1e8 cells";
        if (expected_particles(d) > kMostParticles) return "more than ten million particles";
        const Vec3 size = d.high - d.low;
        const double least = d.dimension == 2 ? std::min(size.x, size.y) : std::min({size.x, size.y, size.z});
        if (!(least >= 4 * d.cell)) return "the box is less than four cells wide";
        return std::nullopt;
      },
      .order = [](const void*) { return 0; }};
  return kCell;
}

namespace {

// What memory and time follow from: blocks.h and substep.h reserve memory for four times the blocks that the
// particles are in and reach (at most all of the box).
struct Counts {
  double particles = 0, fields = 1, table = 0, own = 0, all = 0;
};

Counts counts_of(const MpmDef& d) {
  Counts c;
  c.particles = static_cast<double>(
      largest_count(d, static_cast<size_t>(std::min(expected_particles(d), kMostParticles))));
  const bool plane = d.dimension == 2;
  const double block = plane ? 8 : 4, owners = expected_blocks(d, c.particles);
  c.fields = std::max(1.0, static_cast<double>(velocity_fields(d).size()));
  const double side = side_of(owners / c.fields, d.dimension) + 2;
  c.table = c.fields;
  for (int a = 0; a < d.dimension; ++a) {
    const double size = a == 0 ? d.high.x - d.low.x : a == 1 ? d.high.y - d.low.y : d.high.z - d.low.z;
    c.table *= (size / d.cell + 4 * block) / block + 1;
  }
  c.own = std::min(c.table, 4 * owners + 64);
  c.all = std::min(c.table, 4 * c.fields * side * side * (plane ? 1 : side) + 256);
  return c;
}

}  // namespace

double mpm_step_seconds(const MpmDef& d, double h) {
  const Counts c = counts_of(d);
  const bool plane = d.dimension == 2;
  // Plastic laws need singular values and logarithms.
  double fastest = 0, law = 1;
  const auto count = [&](const MaterialDef& b, double speed) {
    const Material m = material_of(b);
    fastest = std::max({fastest, std::sqrt((m.lambda + 2 * m.mu) / b.density), speed});
    if (b.material == Law::snow || b.material == Law::sand || b.material == Law::foam)
      law = std::max(law, plane ? 2.0 : 2.4);
    if (b.material == Law::corotated && !plane) law = std::max(law, 1.6);
    if (b.material == Law::elastic) law = std::max(law, 8.0);
  };
  for (const BodyDef& b : d.bodies) count(b, norm(b.velocity));
  for (const InletDef& e : d.emitters) count(e, e.speed);
  // Cubic splines reach 16 nodes instead of 9, in space 64 instead of 27.
  const double reach = d.splines == Splines::quadratic ? 1 : plane ? 1.6 : 2.2;
  const double substeps = std::max(1.0, h * fastest / (d.courant * d.cell));
  // A direction takes as many products as a wave would need substeps, or cells to cross.
  const double across = side_of(cells_of(d), 3),
               products = d.is_implicit() ? 6 * std::min(substeps, across) : substeps;
  // A character of an expression is about two thirds of an instruction.
  double letters = 0;
  for (const std::string& text : d.force) letters += static_cast<double>(text.size());
  // Tiles and nodes cost extra, which matters if particles are spread over many blocks.
  return products * (c.particles * (law * reach * (plane ? 2.2e-8 : 6e-8) + 8e-10 * letters) +
                     (c.fields > 1 ? 3e-6 : 1e-6) * c.all / 4);
}

Cost mpm_cost(const void* def) {
  const auto& d = *static_cast<const MpmDef*>(def);
  const double scalar = d.precision == Precision::f32 ? 4 : 8;
  const Counts c = counts_of(d);
  const double n = c.particles;
  const bool plane = d.dimension == 2;
  // A tile and nodes of four numbers for each block; sorted columns before and after a sort, whose lane
  // groups are padded for every block and body.
  const double components = plane ? 17 : 32, lanes = 32 / scalar;
  const double tile = plane ? 12.0 * 13 : 8.0 * 8 * 9;
  const double slots =
      n + std::min(n, c.own * static_cast<double>(d.bodies.size() + d.emitters.size())) * (lanes - 1);
  const double flip = d.transfer == Transfer::flip ? 2 : 1;
  // The implicit step adds seven vectors of nodes and every particle's stiffness.
  const double implicit = d.is_implicit() ? 8 * (7 * 4 * 64 * c.all + slots * (plane ? 14 : 33)) : 0;
  return {.state_bytes = n * (scalar * (plane ? 16 : 26) + (d.changes() ? 12 : 0)),
          .workspace_bytes = slots * (2 * components * scalar + 16) + n * (plane ? 24 : 30) * scalar +
                             flip * 4 * scalar * (c.own * tile + c.all * 64) + 180 * c.all + 4 * c.table +
                             implicit + (c.fields > 1 ? 44 * slots : 0),
          .elements = n,
          // Until the length of a step is known (System::limit).
          .seconds_per_step = mpm_step_seconds(d, 1.0 / 60)};
}

}  // namespace truestep::mpm
