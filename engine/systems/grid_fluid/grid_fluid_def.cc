#include "engine/systems/grid_fluid/grid_fluid_def.h"

#include "engine/systems/grid_fluid/grid_fluid_checks.h"

namespace truestep::grid_fluid {

namespace {
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

const DefTable& second_fluid_table() {
  using D = SecondFluidDef;
  static const DefTable kTable =
      TableOf<D>("another fluid in the same box, which does not mix with the first")
          .expression("where", &D::where,
                      "an expression of x, y, z that is positive where it is at the start, such as y - 0.5; "
                      "nearly linear across a cell, so that the border lies where it is 0")
          .number("density", &D::density, "kg/m^3", above(0), "mass per volume (area in the plane)")
          .number(
              "viscosity", &D::viscosity, "m^2/s", at_least(0),
              "its kinematic viscosity, explicit and with the stress continuous across the border; without "
              "it that of the first fluid")
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
          .text("angle", &D::angle,
                "rad, how far it has turned about `axis` through its middle: an expression of t")
          .vector("axis", &D::axis, "1", any(), "that `angle` turns it about; in the plane z")
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

}  // namespace

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
                  "periodic or slip, or, with `stepping` `steady`, wall or slip; without obstacles")
          .choice("stepping", &D::stepping, {"rk3", "ab2", "steady"},
                  "of central advection: Runge and Kutta's of three stages, Adams and Bashforth's of two "
                  "steps, or steady: the first step finds the flow that no longer changes (in the plane, "
                  "viscous, between sides that are wall, slip or inflow, without obstacles), the others keep "
                  "it")
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
          .object("second_fluid", &D::second_fluid, second_fluid_table(),
                  "another fluid beside the first, with a sharp border; then gravity acts on both")
          .number(
              "vorticity_confinement", &D::vorticity_confinement, "1", at_least(0),
              "strength of the force that gives small eddies back what advection along paths takes from them")
          .objects("obstacles", &D::obstacles, obstacle_table(), {0, 1000}, "solids in the flow")
          .number(
              "tolerance", &D::tolerance, "1", between(1e-14, 0.1),
              "to which the pressure's residual falls where obstacles stand, with two fluids or a surface "
              "(elsewhere it is solved to rounding); of a steady flow how much its last iteration may "
              "change, beside the fastest velocity")
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

}  // namespace truestep::grid_fluid
