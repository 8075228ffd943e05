#include "engine/systems/grid_fluid/grid_fluid_def.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

namespace {
constexpr const char* kSideNames[3][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}, {"z_min", "z_max"}};
constexpr double kMostCells = 5e7, kMostParticles = 2e7;

double cell_count(const GridFluidDef& d) {
  double n = 1;
  for (const int64_t c : d.cells) n *= static_cast<double>(c);
  return n;
}

const DefTable& side_table() {
  using D = FlowSideDef;
  static const DefTable kTable =
      TableOf<D>("what holds on a side")
          .choice(
              "kind", &D::kind, {"wall", "slip", "inflow", "outflow", "periodic"},
              "wall: the fluid sticks to it; slip: it slides along it; inflow: it has the given velocity; "
              "outflow: no pressure and no slope along the normal; periodic: the box goes on at the other "
              "end")
          .texts("velocity", &D::velocity, {0, 3},
                 "m/s, of a wall (along itself) or an inflow: expressions of x, y, z and t")
          .build();
  return kTable;
}

const DefTable& sides_table() {
  using D = FlowSidesDef;
  static const DefTable kTable = TableOf<D>("the sides of the box")
                                     .object("x_min", &D::x_min, side_table(), "where x is smallest")
                                     .object("x_max", &D::x_max, side_table(), "where x is largest")
                                     .object("y_min", &D::y_min, side_table(), "where y is smallest")
                                     .object("y_max", &D::y_max, side_table(), "where y is largest")
                                     .object("z_min", &D::z_min, side_table(), "where z is smallest")
                                     .object("z_max", &D::z_max, side_table(), "where z is largest")
                                     .build();
  return kTable;
}

const DefTable& scalar_table() {
  using D = ScalarDef;
  static const DefTable kTable =
      TableOf<D>("something that the flow carries: smoke, dye, salt, warmth")
          .expression("initial", &D::initial, "at the start, an expression of x, y, z")
          .expression("source", &D::source, "added per second, an expression of x, y, z and t")
          .number("diffusivity", &D::diffusivity, "m^2/s", at_least(0), "how fast it spreads on its own")
          .number("expansion", &D::expansion, "1", any(),
                  "Boussinesq: the fluid is lighter by this share per unit of the scalar and rises against "
                  "gravity; negative: it is heavier and sinks")
          .build();
  return kTable;
}

const DefTable& obstacle_table() {
  using D = ObstacleDef;
  static const DefTable kTable =
      TableOf<D>("a solid in the flow, at rest or moved by the scene")
          .choice("shape", &D::shape, {"sphere", "box"}, "a sphere is a disk in the plane")
          .vector("center", &D::center, "m", any(), "its middle")
          .number("radius", &D::radius, "m", above(0), "of a sphere")
          .vector("half_extents", &D::half, "m", above(0), "of a box")
          .texts("displacement", &D::displacement, {0, 3},
                 "m, how far its middle has moved from `center`: expressions of t; without it it is at rest")
          .build();
  return kTable;
}

const DefTable& body_table() {
  using D = LiquidBodyDef;
  static const DefTable kTable =
      TableOf<D>("liquid at the start")
          .choice("shape", &D::shape, {"sphere", "box"}, "what it fills; a sphere is a disk in the plane")
          .vector("center", &D::center, "m", any(), "its middle")
          .number("radius", &D::radius, "m", above(0), "of a sphere")
          .vector("half_extents", &D::half, "m", above(0), "of a box")
          .vector("velocity", &D::velocity, "m/s", any(), "at the start, added to `initial`")
          .build();
  return kTable;
}

void check_sides(const GridFluidDef& d, const DefTable::Report& report) {
  for (size_t a = 0; a < 3; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const std::string pointer = std::string("/sides/") + kSideNames[a][end];
      if (a >= d.cells.size()) {
        if (d.sides.of(a, end)) report(pointer, "the box has no such side");
        continue;
      }
      const FlowSideDef &mine = side_of(d, a, end), &other = side_of(d, a, 1 - end);
      if (mine.kind == SideKind::periodic && other.kind != SideKind::periodic) {
        report(pointer, "a periodic side needs the opposite one to be periodic too");
      }
      const std::string at = side_pointer(d, a, end) + "/velocity";
      if (mine.velocity.empty()) continue;
      if (mine.kind != SideKind::wall && mine.kind != SideKind::inflow) {
        report(at, "only a wall and an inflow have a velocity of their own");
      } else if (mine.velocity.size() != d.cells.size()) {
        report(at, "as many components as the box has dimensions");
      }
    }
  }
}

// What is not there for liquids with a surface is refused by name.
void check_liquid(const GridFluidDef& d, const DefTable::Report& report) {
  if (!d.liquid()) {
    if (!d.bodies.empty()) report("/bodies", "only advection by flip or apic has a surface to fill up to");
    return;
  }
  if (d.bodies.empty()) report("/bodies", "flip and apic need to know where there is liquid");
  if (d.scalar) report("/scalar", "flip and apic carry nothing but the liquid");
  if (!d.exact.empty()) report("/exact", "flip and apic compare with nothing exact");
  if (d.vorticity_confinement > 0) report("/vorticity_confinement", "not with flip and apic");
  const mac::MacGrid g = make_grid(d);
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (std::abs(g.spacing[a] - g.spacing[0]) > 1e-6 * g.spacing[0] && d.size.size() == d.cells.size()) {
      report("/size",
             "flip and apic need cells that are as long as wide: size / cells alike along every axis");
      break;
    }
  }
  for (size_t a = 0; a < g.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const FlowSideDef& side = side_of(d, a, end);
      const std::string at = side_pointer(d, a, end);
      if (side.kind == SideKind::inflow || side.kind == SideKind::outflow) {
        report(at + "/kind", "sides around a liquid are wall, slip or periodic");
      } else if (!side.velocity.empty()) {
        report(at + "/velocity", "sides around a liquid stand still");
      }
    }
  }
  if (expected_particles(d) > kMostParticles) report("/bodies", "more than 2e7 particles");
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    if (g.dimensions == 2 && d.bodies[k].velocity.z != 0)
      report("/bodies/" + std::to_string(k) + "/velocity", "a plane liquid moves in the plane z = 0");
  }
}

void check_fourth_order(const GridFluidDef& d, const DefTable::Report& report) {
  if (d.advection != GridFluidDef::Advection::central) {
    report("/order", "only central advection has differences of fourth order");
  } else if (!d.obstacles.empty()) {
    report("/order", "walls of obstacles are of second order at most");
  }
  for (size_t a = 0; a < d.cells.size(); ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (kind != SideKind::periodic && kind != SideKind::slip)
        report(side_pointer(d, a, end) + "/kind",
               "differences of fourth order need sides that are periodic or slip");
    }
  }
}

void check_flow(const GridFluidDef& d, const DefTable::Report& report) {
  if (!d.size.empty() && d.size.size() != d.cells.size())
    report("/size", "as many lengths as cells has numbers");
  if (cell_count(d) > kMostCells) report("/cells", "more than 5e7 cells");
  const auto components = [&](const std::vector<std::string>& texts, const char* pointer) {
    if (!texts.empty() && texts.size() != d.cells.size())
      report(pointer, "as many components as the box has dimensions");
  };
  components(d.initial, "/initial"), components(d.force, "/force"), components(d.exact, "/exact");
  for (size_t n = 0; n < d.obstacles.size(); ++n) {
    const std::string at = "/obstacles/" + std::to_string(n) + "/displacement";
    if (d.obstacles[n].displacement.empty()) continue;
    if (d.obstacles[n].displacement.size() != d.cells.size()) {
      report(at, "as many components as the box has dimensions");
    } else if (d.liquid()) {
      report(at, "obstacles around a liquid stand still");
    }
  }
  check_sides(d, report);
  check_liquid(d, report);
  using A = GridFluidDef::Advection;
  if (d.order == GridFluidDef::Order::fourth) check_fourth_order(d, report);
  if (d.advection != A::central && d.viscous == GridFluidDef::Viscous::explicit_) {
    report("/viscous", "advection along paths takes viscosity implicitly");
  }
}
}  // namespace

const std::optional<FlowSideDef>& FlowSidesDef::of(size_t axis, size_t end) const {
  const std::optional<FlowSideDef>* const all[] = {&x_min, &x_max, &y_min, &y_max, &z_min, &z_max};
  return *all[2 * axis + end];
}

const FlowSideDef& side_of(const GridFluidDef& d, size_t axis, size_t end) {
  static const FlowSideDef kWall;
  if (const auto& own = d.sides.of(axis, end)) return *own;
  // A periodic end makes the other one periodic.
  if (const auto& other = d.sides.of(axis, 1 - end); other && other->kind == SideKind::periodic)
    return *other;
  return d.all ? *d.all : kWall;
}

std::string side_pointer(const GridFluidDef& d, size_t axis, size_t end) {
  return d.sides.of(axis, end) ? std::string("/sides/") + kSideNames[axis][end] : "/side";
}

mac::MacGrid make_grid(const GridFluidDef& d) {
  mac::MacGrid g;
  g.dimensions = d.cells.size();
  for (size_t a = 0; a < g.dimensions; ++a) {
    g.cells[a] = static_cast<size_t>(d.cells[a]);
    g.spacing[a] = (d.size.empty() ? 1 : d.size[a]) / static_cast<double>(g.cells[a]);
    if (d.origin) g.origin[a] = a == 0 ? d.origin->x : a == 1 ? d.origin->y : d.origin->z;
    g.periodic[a] = side_of(d, a, 0).kind == SideKind::periodic;
  }
  return g;
}

std::vector<StartingPlace> starting_places(const GridFluidDef& d) {
  const mac::MacGrid g = make_grid(d);
  const auto per = static_cast<size_t>(d.particles_per_axis);
  std::vector<StartingPlace> out;
  std::vector<ObstacleDef> shapes;
  for (const LiquidBodyDef& b : d.bodies)
    shapes.push_back({.shape = b.shape, .center = b.center, .radius = b.radius, .half = b.half});
  const auto place = [&](size_t a, size_t i) {
    return a < g.dimensions
               ? g.origin[a] + g.spacing[a] * (static_cast<double>(i) + 0.5) / static_cast<double>(per)
               : 0.0;
  };
  for (size_t k = 0; k < (g.dimensions == 3 ? per * g.cells[2] : 1); ++k) {
    for (size_t j = 0; j < per * g.cells[1]; ++j) {
      for (size_t i = 0; i < per * g.cells[0]; ++i) {
        const Vec3 at{place(0, i), place(1, j), place(2, k)};
        size_t body = 0;
        while (body < shapes.size() && distance_to({&shapes[body], 1}, at, g.dimensions) > 0) ++body;
        if (body == shapes.size() || distance_to(d.obstacles, at, g.dimensions) <= 0) continue;
        out.push_back({at, body});
      }
    }
  }
  return out;
}

double expected_particles(const GridFluidDef& d) {
  const mac::MacGrid g = make_grid(d);
  constexpr double kPi = 3.14159265358979323846;
  double volume = 0, all = 1;
  for (size_t a = 0; a < g.dimensions; ++a) all *= g.extent(a);
  for (const LiquidBodyDef& b : d.bodies) {
    const bool plane = g.dimensions == 2;
    const double r = b.radius;
    if (b.shape == ObstacleDef::Shape::sphere) {
      volume += plane ? kPi * r * r : 4 * kPi / 3 * r * r * r;
      continue;
    }
    // The part of a box that lies in the grid.
    const double center[] = {b.center.x, b.center.y, b.center.z}, half[] = {b.half.x, b.half.y, b.half.z};
    double part = 1;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double low = std::max(center[a] - half[a], g.origin[a]);
      part *= std::max(0.0, std::min(center[a] + half[a], g.origin[a] + g.extent(a)) - low);
    }
    volume += part;
  }
  return std::min(volume, all) / g.cell_volume() *
         trig::pow(static_cast<double>(d.particles_per_axis), static_cast<double>(g.dimensions));
}

const DefTable& grid_fluid_table() {
  using D = GridFluidDef;
  static const DefTable kTable =
      TableOf<D>("an incompressible fluid in a box of two or three dimensions, on a staggered grid")
          .integers("cells", &D::cells, between(4, 1e6), {2, 3}, "cells along x, y and perhaps z")
          .numbers("size", &D::size, "m", above(0), {0, 3},
                   "lengths of the box; without them 1 along every axis")
          .vector("origin", &D::origin, "m", any(), "lower corner of the box")
          .object("side", &D::all, side_table(),
                  "all sides that are not given on their own; without it walls at rest")
          .object("sides", &D::sides, sides_table(), "single sides")
          .number("viscosity", &D::viscosity, "m^2/s", at_least(0), "kinematic viscosity")
          .number("density", &D::density, "kg/m^3", above(0), "mass per volume (area in the plane)")
          .choice("advection", &D::advection,
                  {"central", "semi_lagrangian", "maccormack", "bfecc", "flip", "apic"},
                  "central: differences of second order that keep energy, for smooth flows; the next three "
                  "trace paths backwards and hold any step: of first order, or corrected to second with "
                  "limits; flip and apic: liquids with a surface, carried by particles that keep what the "
                  "grid changes of their velocity (flip) or its slopes (apic)")
          .choice("order", &D::order, {"second", "fourth"},
                  "of central advection's differences; fourth for smooth flows between sides that are "
                  "periodic or "
                  "slip, without obstacles")
          .choice("stepping", &D::stepping, {"rk3", "ab2"},
                  "of central advection: Runge and Kutta's of three stages, or Adams and Bashforth's of two "
                  "steps")
          .choice(
              "viscous", &D::viscous, {"automatic", "explicit", "implicit"},
              "how viscosity is stepped; automatic: explicit with central advection where the step holds it")
          .number("cfl", &D::cfl, "1", between(1e-3, 100),
                  "cells that anything may cross in a substep; without it 1.2 for rk3, 0.5 for ab2, 3 along "
                  "paths, 1 for flip and apic")
          .texts("initial", &D::initial, {0, 3}, "m/s, velocity at the start: expressions of x, y, z")
          .texts("force", &D::force, {0, 3}, "m/s^2, acceleration: expressions of x, y, z and t")
          .texts("exact", &D::exact, {0, 3}, "m/s, velocity that is known: expressions of x, y, z and t")
          .object("scalar", &D::scalar, scalar_table(), "what the flow carries")
          .number(
              "vorticity_confinement", &D::vorticity_confinement, "1", at_least(0),
              "strength of the force that gives small eddies back what advection along paths takes from them")
          .objects("obstacles", &D::obstacles, obstacle_table(), {0, 1000}, "solids in the flow")
          .number("tolerance", &D::tolerance, "1", between(1e-14, 0.1),
                  "to which the pressure's residual falls where obstacles stand or there is a surface; "
                  "elsewhere it is solved to rounding")
          .objects("bodies", &D::bodies, body_table(), {0, 1000},
                   "of flip and apic: where there is liquid at the start")
          .integer("particles_per_axis", &D::particles_per_axis, between(1, 4),
                   "of flip and apic, in a cell: 2 makes 4 in the plane, 8 in space")
          .number("flip", &D::flip, "1", between(0, 1),
                  "of flip: what particles keep of their own velocity; 0 is PIC")
          .check(check_flow)
          .build();
  return kTable;
}

const Outputs& grid_fluid_outputs() {
  static const Outputs kOutputs{
      .rows = "a cell, x running fastest; of a liquid a particle",
      .fields = {{"velocity", "m/s", 3, "velocity in the cell's centre"},
                 {"speed", "m/s", 1, "its magnitude"},
                 {"pressure", "Pa", 1, "pressure"},
                 {"vorticity", "1/s", 1,
                  "curl of the velocity: along z in the plane, its magnitude in space"},
                 {"scalar", "1", 1, "what the flow carries"},
                 {"fill", "1", 1, "of a liquid: what of the cell around the particle it fills"},
                 {"position", "m", 3, "of a liquid's particle"}},
      .observables = {
          {"energy.kinetic", "J", "of the fluid in the box"},
          {"enstrophy", "1/s^2", "half the square of the vorticity, integrated over the box"},
          {"divergence.max", "1/s", "largest divergence of a cell"},
          {"speed.max", "m/s", "largest component of the velocity on a face"},
          {"cfl", "1", "cells that the fastest crosses in a substep"},
          {"substeps", "1", "substeps of the last step"},
          {"pressure.iterations", "1", "of the last substep's last solve; 0: solved directly"},
          {"pressure.residual", "1", "what is left of the right-hand side then"},
          {"scalar.total", "1", "integral of what the flow carries"},
          {"obstacle.drag", "N", "force of the fluid on the obstacles along x, over the last substep"},
          {"obstacle.lift", "N", "the same along y"},
          {"energy.gravity", "J", "of a liquid: potential, about the origin"},
          {"energy.total", "J", "of a liquid: its sum with the kinetic energy"},
          {"momentum.x", "kg m/s", "of a liquid"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"centre.x", "m", "of a liquid's mass"},
          {"centre.y", "m", ""},
          {"centre.z", "m", ""},
          {"low.x", "m", "least coordinate of a liquid's particles"},
          {"low.y", "m", ""},
          {"low.z", "m", ""},
          {"high.x", "m", "greatest coordinate of a liquid's particles"},
          {"high.y", "m", ""},
          {"high.z", "m", ""},
          {"mass", "kg", "of all particles of a liquid"},
          {"density.mean_error", "1", "of a liquid: mean compression of its cells in the last substep"},
          {"density.max_error", "1", "the largest"},
          {"density.iterations", "1", "of the solve that takes it back"},
          {"error.exact", "m/s", "distance from the scene's exact velocity, root mean square"}}};
  return kOutputs;
}

namespace {
// Faces, cells and the levels of the pressure's solver; particles in the state, twice in the order of cells.
Cost liquid_cost(const GridFluidDef& d, double padded) {
  const auto dim = static_cast<double>(d.cells.size());
  const double n = expected_particles(d),
               affine = d.advection == GridFluidDef::Advection::apic ? dim * dim : 0;
  Cost c;
  c.state_bytes = 8 * padded * 2 + 8 * n * (6 + affine) + 4e3;
  // Rows of faces with their neighbours, as many as the liquid has.
  const double cells = n / trig::pow(static_cast<double>(d.particles_per_axis), dim);
  const double viscous = d.viscosity > 0 ? 4 * padded + cells * (60 + 24 * dim) : 0;
  const double solver = (dim == 2 ? 4.0 / 3 : 8.0 / 7) * (8 * (dim + 4) + 1) + 8 * 5;
  c.workspace_bytes =
      padded * (8 * (5 * dim + 3) + dim + 2 + solver) + viscous + n * (16 * (2 * dim + affine) + 12) + 3e5;
  c.elements = n;
  c.seconds_per_step = 1e-4 + 1e-6 * padded + 6e-7 * n;
  return c;
}
}  // namespace

Cost grid_fluid_cost(const void* def) {
  const auto& d = *static_cast<const GridFluidDef*>(def);
  double padded = 1;
  for (const int64_t c : d.cells) padded *= static_cast<double>(c) + 2.0 * mac::kGhosts + 1;
  if (d.liquid()) return liquid_cost(d, padded);
  const double components = static_cast<double>(d.cells.size());
  const bool ab2 = d.stepping == GridFluidDef::Stepping::ab2;
  const double solids = d.obstacles.empty() ? 0 : components + 1;
  const bool moving =
      std::ranges::any_of(d.obstacles, [](const ObstacleDef& o) { return !o.displacement.empty(); });
  Cost c;
  c.state_bytes = 8 * padded * (components + 1 + (ab2 ? components : 0) + (d.scalar ? 1 : 0)) + 4e3;
  // Rates, right-hand sides and transforms; ways there and back of the scalar; fractions and levels where
  // there are solids.
  c.workspace_bytes = 8 * padded * (3 * components + 4 + 4 * solids + (d.scalar ? 5 : 0)) + 3e5;
  // Shares of faces again.
  if (moving) c.workspace_bytes += padded * (17 * components + 1);
  c.elements = cell_count(d);
  // Measured on one core: a substep's transforms and differences.
  c.seconds_per_step = 1e-5 + 1.5e-7 * padded;
  return c;
}

const Resolution& grid_fluid_resolution() {
  static const Resolution kCells{.parameter = "cells",
                                 .divide = [](void* def, double factor) -> std::optional<std::string> {
                                   auto& d = *static_cast<GridFluidDef*>(def);
                                   for (int64_t& cells : d.cells) {
                                     const double wanted = factor * static_cast<double>(cells);
                                     if (wanted != std::floor(wanted) || wanted < 4)
                                       return "cells are whole numbers of at least 4";
                                     cells = static_cast<int64_t>(wanted);
                                   }
                                   if (cell_count(d) > kMostCells) return "more than 5e7 cells";
                                   return std::nullopt;
                                 },
                                 .order =
                                     [](const void* def) {
                                       const auto& d = *static_cast<const GridFluidDef*>(def);
                                       if (d.order == GridFluidDef::Order::fourth) return 4;
                                       return d.advection == GridFluidDef::Advection::semi_lagrangian ? 1 : 2;
                                     }};
  return kCells;
}

}  // namespace truestep::grid_fluid
