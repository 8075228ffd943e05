#include "engine/systems/grid_fluid/grid_fluid_checks.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/steady_flow.h"

namespace truestep::grid_fluid {

double cell_count(const GridFluidDef& d) {
  double n = 1;
  for (const int64_t c : d.cells) n *= static_cast<double>(c);
  return n;
}

namespace {
constexpr const char* kSideNames[3][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}, {"z_min", "z_max"}};
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

namespace {
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
      if (d.steady()) {
        if (kind != SideKind::wall && kind != SideKind::slip)
          report(side_pointer(d, a, end) + "/kind",
                 "steady flows of fourth order need sides that are wall or slip");
      } else if (kind != SideKind::periodic && kind != SideKind::slip)
        report(side_pointer(d, a, end) + "/kind",
               "differences of fourth order need sides that are periodic or slip");
    }
  }
}

// Two fluids: what is not there is refused by name.
void check_two_fluids(const GridFluidDef& d, const DefTable::Report& report) {
  if (d.liquid()) report("/second_fluid", "flip and apic have one liquid and nothing beside it");
  if (d.steady()) report("/second_fluid", "steady flows are those of one fluid");
  if (d.order == GridFluidDef::Order::fourth)
    report("/second_fluid", "differences of fourth order need one density");
  if (!d.obstacles.empty()) report("/obstacles", "two fluids have no obstacles between them");
  if (d.second_fluid->viscosity) {
    if (d.advection != GridFluidDef::Advection::central)
      report("/second_fluid/viscosity", "two viscosities need central advection");
    if (d.viscous == GridFluidDef::Viscous::implicit) report("/viscous", "two viscosities are explicit");
  }
  constexpr double kMostRatio = 1000;
  const double ratio = d.second_fluid->density / d.density;
  if (!(ratio <= kMostRatio && ratio >= 1 / kMostRatio))
    report("/second_fluid/density", "at most 1000 times as heavy as the other fluid");
  for (size_t a = 0; a < d.cells.size(); ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (kind == SideKind::inflow || kind == SideKind::outflow)
        report(side_pointer(d, a, end) + "/kind", "sides around two fluids are wall, slip or periodic");
    }
  }
}

// What a search for steady states does not know is refused by name.
void check_steady(const GridFluidDef& d, const DefTable::Report& report) {
  using A = GridFluidDef::Advection;
  if (d.advection != A::central) report("/advection", "steady flows are found with central advection");
  if (!(d.viscosity > 0)) report("/viscosity", "a steady flow needs viscosity");
  if (d.viscous != GridFluidDef::Viscous::automatic)
    report("/viscous", "nothing is stepped in a steady flow");
  if (d.cfl) report("/cfl", "nothing is stepped in a steady flow");
  if (d.scalar) report("/scalar", "a steady flow carries nothing");
  if (!d.obstacles.empty()) report("/obstacles", "steady flows are found without obstacles");
  if (!d.initial.empty()) report("/initial", "a steady flow has no start");
  if (d.cells.size() != 2) {
    report("/cells", "steady flows are found in the plane");
    return;
  }
  if (std::min(d.cells[0], d.cells[1]) > static_cast<int64_t>(SteadyFlow::kMostAcross))
    report("/cells", "a steady flow is found on at most 512 cells along the shorter axis");
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (kind == SideKind::periodic || kind == SideKind::outflow)
        report(side_pointer(d, a, end) + "/kind", "sides around a steady flow are wall, slip or inflow");
    }
  }
}
}  // namespace

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
    const std::string at = "/obstacles/" + std::to_string(n);
    const ObstacleDef& o = d.obstacles[n];
    if (!o.displacement.empty() && o.displacement.size() != d.cells.size())
      report(at + "/displacement", "as many components as the box has dimensions");
    if (norm2(o.axis) == 0) report(at + "/axis", "an axis has a direction");
    if (d.cells.size() == 2 && (o.axis.x != 0 || o.axis.y != 0))
      report(at + "/axis", "in the plane obstacles turn about z");
  }
  check_sides(d, report);
  check_liquid(d, report);
  using A = GridFluidDef::Advection;
  if (d.steady()) check_steady(d, report);
  if (d.second_fluid) check_two_fluids(d, report);
  if (d.order == GridFluidDef::Order::fourth) check_fourth_order(d, report);
  if (d.advection != A::central && d.viscous == GridFluidDef::Viscous::explicit_) {
    report("/viscous", "advection along paths takes viscosity implicitly");
  }
}

}  // namespace truestep::grid_fluid
