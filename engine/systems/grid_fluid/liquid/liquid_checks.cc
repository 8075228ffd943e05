// Consistency checks of a liquid with a surface, and how many particles it may have.
#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/grid_fluid/grid_fluid_checks.h"
#include "engine/systems/grid_fluid/liquid/inlet.h"

namespace truestep::grid_fluid {

namespace {

template <class F>
void for_box_sides(const GridFluidDef& d, F&& f) {
  for (size_t a = 0; a < d.cells.size(); ++a) {
    for (size_t end = 0; end < 2; ++end) f(side_of(d, a, end), side_pointer(d, a, end));
  }
}

bool any_side(const GridFluidDef& d, SideKind kind) {
  bool any = false;
  for_box_sides(d, [&](const FlowSideDef& side, const std::string&) { any = any || side.kind == kind; });
  return any;
}

// The nozzle, two cells deep, must lie in the box.
void check_nozzle(const GridFluidDef& d, const LiquidInletDef& def, const std::string& at,
                  const DefTable::Report& report) {
  const mac::MacGrid g = make_grid(d);
  if (g.dimensions == 2 && def.direction.z != 0)
    return report(at + "/direction", "a plane liquid moves in z = 0");
  const LiquidInlet inlet(d, def);
  if (inlet.places.empty()) return report(at + "/radius", "is too small for a single particle");
  const auto inside = [&](const Vec3& p) {
    const double x[] = {p.x, p.y, p.z};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double slack = 1e-9 * g.extent(a);
      if (x[a] < g.origin[a] - slack || x[a] > g.origin[a] + g.extent(a) + slack) return false;
    }
    return true;
  };
  for (const Vec3& p : inlet.places) {
    if (inside(inlet.mouth + p) && inside(inlet.back() + p)) continue;
    return report(at + "/position", "the nozzle, two cells deep behind its position, must lie in the box");
  }
}

void check_no_liquid(const GridFluidDef& d, const DefTable::Report& report) {
  constexpr const char* kOnly = "only flip and apic have a surface";
  if (!d.bodies.empty()) report("/bodies", kOnly);
  if (!d.emitters.empty()) report("/emitters", kOnly);
  if (!d.kill_planes.empty()) report("/kill_planes", kOnly);
  if (!d.kill_boxes.empty()) report("/kill_boxes", kOnly);
  if (d.max_particles) report("/max_particles", kOnly);
  for_box_sides(d, [&](const FlowSideDef& side, const std::string& at) {
    if (side.dye) report(at + "/dye", "only liquids by flip and apic have a dye: others carry a `scalar`");
  });
}

}  // namespace

void check_liquid(const GridFluidDef& d, const DefTable::Report& report) {
  if (!d.liquid()) return check_no_liquid(d, report);
  if (d.bodies.empty() && d.emitters.empty() && !any_side(d, SideKind::inflow))
    report("/bodies", "flip and apic need liquid: bodies, emitters, or a side of kind inflow");
  if (d.scalar) report("/scalar", "not with flip and apic, whose bodies and emitters have a `dye`");
  if (!d.exact.empty()) report("/exact", "flip and apic have no exact solution");
  if (d.vorticity_confinement > 0) report("/vorticity_confinement", "not with flip and apic");
  const mac::MacGrid g = make_grid(d);
  bool cubic = true;
  for (size_t a = 0; a < g.dimensions && cubic; ++a) {
    cubic = std::abs(g.spacing[a] - g.spacing[0]) <= 1e-6 * g.spacing[0] || d.size.size() != d.cells.size();
    if (!cubic) report("/size", "flip and apic need cubic cells: the same size / cells along every axis");
  }
  for_box_sides(d, [&](const FlowSideDef& side, const std::string& at) {
    if (side.kind == SideKind::wall && !side.velocity.empty())
      report(at + "/velocity", "walls around a liquid must be at rest");
    if (side.dye && side.kind != SideKind::inflow) report(at + "/dye", "only what flows in has a dye");
  });
  if (expected_particles(d) > kMostParticles) report("/bodies", "more than 2e7 particles");
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    if (g.dimensions == 2 && d.bodies[k].velocity.z != 0)
      report("/bodies/" + std::to_string(k) + "/velocity", "a plane liquid must move in the plane z = 0");
  }
  for (size_t k = 0; k < d.emitters.size() && cubic; ++k)
    check_nozzle(d, d.emitters[k], "/emitters/" + std::to_string(k), report);
  if (d.max_particles && static_cast<double>(*d.max_particles) < expected_particles(d))
    report("/max_particles", "fewer than the particles at t = 0");
}

bool lets_through(SideKind kind) {
  return kind == SideKind::inflow || kind == SideKind::outflow;
}

bool changes(const GridFluidDef& d) {
  return !d.emitters.empty() || d.any_regions() || any_side(d, SideKind::inflow) ||
         any_side(d, SideKind::outflow);
}

bool dyed(const GridFluidDef& d) {
  bool any = false;
  for_box_sides(d, [&](const FlowSideDef& side, const std::string&) { any = any || side.dye; });
  for (const LiquidBodyDef& b : d.bodies) any = any || b.dye;
  for (const LiquidInletDef& e : d.emitters) any = any || e.dye;
  return any;
}

size_t largest_count(const GridFluidDef& d, size_t start) {
  if (!changes(d)) return start;
  if (d.max_particles) return std::max(static_cast<size_t>(*d.max_particles), start);
  constexpr double kSqueezed = 1.1;  // a splash is compressed for a while
  const double per =
      trig::pow(static_cast<double>(d.particles_per_axis), static_cast<double>(d.cells.size()));
  double n = any_side(d, SideKind::inflow) ? HUGE_VAL : static_cast<double>(start);
  for (const LiquidInletDef& e : d.emitters) n += LiquidInlet(d, e).most();
  n = std::min({n, kSqueezed * per * cell_count(d), kMostParticles});
  return std::max(static_cast<size_t>(n), start);
}

}  // namespace truestep::grid_fluid
