#include "engine/systems/grid_fluid/grid_fluid_checks.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/steady/steady_flow.h"

namespace truestep::grid_fluid {

double cell_count(const GridFluidDef& d) {
  double n = 1;
  for (const int64_t c : d.cells) n *= static_cast<double>(c);
  return n;
}

using lattice::kSideNames;

const FlowSideDef& side_of(const GridFluidDef& d, size_t axis, size_t end) {
  static const FlowSideDef kWall;
  if (const auto& own = d.sides.of(axis, end)) return *own;
  // If one end is periodic, so is the other.
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
  if (d.origin) g.origin = {d.origin->x, d.origin->y, d.origin->z};
  for (size_t a = 0; a < g.dimensions; ++a) {
    g.cells[a] = static_cast<size_t>(d.cells[a]);
    g.spacing[a] = (d.size.empty() ? 1 : d.size[a]) / static_cast<double>(g.cells[a]);
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
        report(pointer, "a periodic side needs a periodic opposite side");
      }
      const std::string at = side_pointer(d, a, end) + "/velocity";
      if (mine.velocity.empty()) continue;
      if (mine.kind != SideKind::wall && mine.kind != SideKind::inflow) {
        report(at, "only wall and inflow have a velocity");
      } else if (mine.velocity.size() != d.cells.size()) {
        report(at, "needs as many components as the box has dimensions");
      }
    }
  }
}

void check_fourth_order(const GridFluidDef& d, const DefTable::Report& report) {
  if (d.advection != GridFluidDef::Advection::central) {
    report("/order", "fourth order needs central advection");
  } else if (!d.obstacles.empty()) {
    report("/order", "fourth order does not support obstacles");
  }
  for (size_t a = 0; a < d.cells.size(); ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (d.steady()) {
        if (kind != SideKind::wall && kind != SideKind::slip)
          report(side_pointer(d, a, end) + "/kind", "steady flows of fourth order need wall or slip sides");
      } else if (kind != SideKind::periodic && kind != SideKind::slip)
        report(side_pointer(d, a, end) + "/kind", "fourth order needs periodic or slip sides");
    }
  }
}

// The same for two fluids.
void check_two_fluids(const GridFluidDef& d, const DefTable::Report& report) {
  if (d.liquid()) report("/second_fluid", "flip and apic support a single liquid");
  if (d.steady()) report("/second_fluid", "steady flows support a single fluid");
  if (d.order == GridFluidDef::Order::fourth) report("/second_fluid", "fourth order needs a single density");
  if (!d.obstacles.empty()) report("/obstacles", "two fluids do not support obstacles");
  if (d.second_fluid->viscosity) {
    if (d.advection != GridFluidDef::Advection::central)
      report("/second_fluid/viscosity", "two viscosities need central advection");
    if (d.viscous == GridFluidDef::Viscous::implicit) report("/viscous", "two viscosities are explicit");
  }
  constexpr double kMostRatio = 1000;
  const double ratio = d.second_fluid->density / d.density;
  if (!(ratio <= kMostRatio && ratio >= 1 / kMostRatio))
    report("/second_fluid/density", "densities may differ by a factor of at most 1000");
  for (size_t a = 0; a < d.cells.size(); ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (kind == SideKind::inflow || kind == SideKind::outflow)
        report(side_pointer(d, a, end) + "/kind", "sides around two fluids must be wall, slip or periodic");
    }
  }
}

// The same for steady flows.
void check_steady(const GridFluidDef& d, const DefTable::Report& report) {
  using A = GridFluidDef::Advection;
  if (d.advection != A::central) report("/advection", "steady flows need central advection");
  if (!(d.viscosity > 0)) report("/viscosity", "a steady flow needs viscosity above 0");
  if (d.viscous != GridFluidDef::Viscous::automatic) report("/viscous", "a steady flow is not stepped");
  if (d.cfl) report("/cfl", "a steady flow is not stepped");
  if (d.scalar) report("/scalar", "a steady flow carries no scalar");
  if (!d.obstacles.empty()) report("/obstacles", "steady flows do not support obstacles");
  if (!d.initial.empty()) report("/initial", "a steady flow has no initial velocity");
  if (d.cells.size() != 2) {
    report("/cells", "steady flows are found only in the plane");
    return;
  }
  if (std::min(d.cells[0], d.cells[1]) > static_cast<int64_t>(SteadyFlow::kMostAcross))
    report("/cells", "steady flows support at most 512 cells along the shorter axis");
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const SideKind kind = side_of(d, a, end).kind;
      if (kind == SideKind::periodic || kind == SideKind::outflow)
        report(side_pointer(d, a, end) + "/kind", "sides around a steady flow must be wall, slip or inflow");
    }
  }
}
}  // namespace

void check_flow(const GridFluidDef& d, const DefTable::Report& report) {
  if (!d.size.empty() && d.size.size() != d.cells.size())
    report("/size", "needs as many lengths as there are axes in cells");
  if (cell_count(d) > kMostCells) report("/cells", "more than 5e7 cells");
  const auto components = [&](const std::vector<std::string>& texts, const char* pointer) {
    if (!texts.empty() && texts.size() != d.cells.size())
      report(pointer, "needs as many components as the box has dimensions");
  };
  components(d.initial, "/initial"), components(d.force, "/force"), components(d.exact, "/exact");
  for (size_t n = 0; n < d.obstacles.size(); ++n) {
    const std::string at = "/obstacles/" + std::to_string(n);
    const ObstacleDef& o = d.obstacles[n];
    if (!o.displacement.empty() && o.displacement.size() != d.cells.size())
      report(at + "/displacement", "needs as many components as the box has dimensions");
    if (norm2(o.axis) == 0) report(at + "/axis", "the axis must not be zero");
    if (d.cells.size() == 2 && (o.axis.x != 0 || o.axis.y != 0))
      report(at + "/axis", "in the plane obstacles rotate about z");
  }
  check_sides(d, report);
  check_liquid(d, report);
  using A = GridFluidDef::Advection;
  if (d.steady()) check_steady(d, report);
  if (d.second_fluid) check_two_fluids(d, report);
  if (d.order == GridFluidDef::Order::fourth) check_fourth_order(d, report);
  if (d.advection != A::central && d.viscous == GridFluidDef::Viscous::explicit_) {
    report("/viscous", "advection along paths needs implicit viscosity");
  }
}

}  // namespace truestep::grid_fluid
