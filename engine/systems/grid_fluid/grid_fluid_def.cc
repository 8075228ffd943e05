#include "engine/systems/grid_fluid/grid_fluid_def.h"

#include "engine/systems/grid_fluid/grid_fluid_checks.h"

namespace truestep::grid_fluid {

namespace {
const DefTable& side_table() {
  using D = FlowSideDef;
  static const DefTable kTable =
      TableOf<D>("the condition on a side")
          .choice("kind", &D::kind, {"wall", "slip", "inflow", "outflow", "periodic"},
                  "wall: no slip; slip: the fluid slides along it; inflow: it has the given "
                  "velocity; outflow: zero pressure and zero slope along the normal; periodic: the fluid "
                  "re-enters at the other end")
          .texts("velocity", &D::velocity, {0, 3},
                 "m/s, of a wall (along itself) or an inflow: expressions of x, y, z and t")
          .number("dye", &D::dye, "1", any(), "of flip and apic: dye of the liquid that flows in")
          .build();
  return kTable;
}

const DefTable& scalar_table() {
  using D = ScalarDef;
  static const DefTable kTable =
      TableOf<D>("a scalar that the flow carries: smoke, dye, salt, heat")
          .expression("initial", &D::initial, "value at the start, an expression of x, y, z")
          .expression("source", &D::source, "rate of change per second, an expression of x, y, z and t")
          .number("diffusivity", &D::diffusivity, "m^2/s", at_least(0), "diffusion coefficient")
          .number("expansion", &D::expansion, "1", any(),
                  "Boussinesq buoyancy: relative decrease of density per unit of the scalar; negative: the "
                  "fluid becomes heavier and sinks")
          .build();
  return kTable;
}

const DefTable& second_fluid_table() {
  using D = SecondFluidDef;
  static const DefTable kTable =
      TableOf<D>("a second fluid in the same box that does not mix with the first")
          .expression("where", &D::where,
                      "an expression of x, y, z, positive inside the second fluid at the start, such as y - "
                      "0.5; nearly linear across a cell, so that the border is where it is 0")
          .number("density", &D::density, "kg/m^3", above(0), "mass per volume (area in the plane)")
          .number(
              "viscosity", &D::viscosity, "m^2/s", at_least(0),
              "its kinematic viscosity, stepped explicitly, with the stress continuous across the border; "
              "absent: that of the first fluid")
          .build();
  return kTable;
}

const DefTable& obstacle_table() {
  using D = ObstacleDef;
  static const DefTable kTable =
      TableOf<D>("a solid in the flow, at rest or moved by the scene")
          .choice("shape", &D::shape, {"sphere", "box"}, "in the plane a sphere is a disk")
          .vector("center", &D::center, "m", any(), "centre of the shape")
          .number("radius", &D::radius, "m", above(0), "of a sphere")
          .vector("half_extents", &D::half, "m", above(0), "of a box")
          .texts("displacement", &D::displacement, {0, 3},
                 "m, displacement from `center`: expressions of t; absent: at rest")
          .text("angle", &D::angle,
                "rad, angle of rotation about `axis` through its centre: an expression of t")
          .vector("axis", &D::axis, "1", any(), "of the rotation by `angle`; in the plane z")
          .build();
  return kTable;
}

const DefTable& body_table() {
  using D = LiquidBodyDef;
  static const DefTable kTable =
      TableOf<D>("liquid at the start")
          .choice("shape", &D::shape, {"sphere", "box"}, "region to fill; in the plane a sphere is a disk")
          .vector("center", &D::center, "m", any(), "centre of the shape")
          .number("radius", &D::radius, "m", above(0), "of a sphere")
          .vector("half_extents", &D::half, "m", above(0), "of a box")
          .vector("velocity", &D::velocity, "m/s", any(), "initial, added to the system's `initial`")
          .number("dye", &D::dye, "1", any(), "a number that its particles carry along; absent: 0")
          .build();
  return kTable;
}

const DefTable& inlet_table() {
  using D = LiquidInletDef;
  static const DefTable kTable = [] {
    TableOf<D> table(
        "a nozzle: a disk, or in the plane a line, that pours liquid in layers one particle apart");
    return add_source_rows(table)
        .number("dye", &D::dye, "1", any(), "a number that its particles carry along; absent: 0")
        .check([](const D& d, const DefTable::Report& report) {
          check_source(d, report);
          if (!(d.speed > 0)) report("/speed", "a nozzle needs a speed above 0");
        })
        .build();
  }();
  return kTable;
}

}  // namespace

const DefTable& grid_fluid_table() {
  using D = GridFluidDef;
  static const DefTable kTable = [] {
    TableOf<D> table("an incompressible fluid in a box of two or three dimensions, on a staggered grid");
    table.integers("cells", &D::cells, between(4, 1e6), {2, 3}, "cells along x, y and, in space, z")
        .numbers("size", &D::size, "m", above(0), {0, 3}, "lengths of the box; absent: 1 along every axis")
        .vector("origin", &D::origin, "m", any(), "lower corner of the box")
        .object("side", &D::all, side_table(),
                "all sides without their own entry in `sides`; absent: walls at rest")
        .object("sides", &D::sides, lattice::box_sides_table<FlowSideDef>(side_table()), "individual sides")
        .number("viscosity", &D::viscosity, "m^2/s", at_least(0), "kinematic viscosity")
        .number("density", &D::density, "kg/m^3", above(0), "mass per volume (area in the plane)")
        .choice(
            "advection", &D::advection, {"central", "semi_lagrangian", "maccormack", "bfecc", "flip", "apic"},
            "central: energy-conserving differences of second order, for smooth flows; semi_lagrangian, "
            "maccormack, bfecc: backward paths, stable for any step, of first order or limited second "
            "order; flip, apic: liquids with a surface, carried by particles that add the grid's change to "
            "their velocity (flip) or keep the grid's velocity and slopes (apic)")
        .choice("order", &D::order, {"second", "fourth"},
                "of the central differences; fourth: for smooth flows without obstacles between periodic "
                "or slip sides, or with `stepping` `steady` wall or slip sides")
        .choice("stepping", &D::stepping, {"rk3", "ab2", "steady"},
                "of central advection: rk3: three-stage Runge-Kutta; ab2: two-step Adams-Bashforth; "
                "steady: the first step finds the steady flow (viscous, in the plane, between wall, slip "
                "or inflow sides, without obstacles), later ones keep it")
        .choice("viscous", &D::viscous, {"automatic", "explicit", "implicit"},
                "how viscosity is stepped; automatic: explicit with central advection if it is stable at "
                "this step, otherwise implicit")
        .number("cfl", &D::cfl, "1", between(1e-3, 100),
                "cells that anything may cross per substep; absent: 1.2 for rk3, 0.5 for ab2, 3 along "
                "paths, 1 for flip and apic")
        .texts("initial", &D::initial, {0, 3}, "m/s, initial velocity: expressions of x, y, z")
        .texts("force", &D::force, {0, 3}, "m/s^2, acceleration: expressions of x, y, z and t")
        .texts("exact", &D::exact, {0, 3}, "m/s, exact velocity: expressions of x, y, z and t")
        .object("scalar", &D::scalar, scalar_table(), "a scalar that the flow carries")
        .object("second_fluid", &D::second_fluid, second_fluid_table(),
                "a second fluid with a sharp border to the first; gravity then acts on both")
        .number("vorticity_confinement", &D::vorticity_confinement, "1", at_least(0),
                "strength of vorticity confinement: drives the small eddies that advection along paths damps")
        .objects("obstacles", &D::obstacles, obstacle_table(), {0, 1000}, "obstacles in the flow")
        .number("tolerance", &D::tolerance, "1", between(1e-14, 0.1),
                "relative residual of the pressure with obstacles, two fluids or a surface (otherwise it "
                "is solved to rounding); for a steady flow, change in the last iteration relative to the "
                "largest velocity")
        .objects("bodies", &D::bodies, body_table(), {0, 1000}, "of flip and apic: liquid at the start")
        .integer("particles_per_axis", &D::particles_per_axis, between(1, 4),
                 "of flip and apic: particles per cell along each axis; 2 gives 4 in the plane, 8 in space")
        .number("flip", &D::flip, "1", between(0, 1),
                "of flip: share of their own velocity that particles keep; 0 is PIC")
        .objects("emitters", &D::emitters, inlet_table(), {0, 64}, "of flip and apic: nozzles")
        .integer("max_particles", &D::max_particles, between(1, kMostParticles),
                 "of flip and apic: most particles at once; absent: enough for the emitters, at most a tenth "
                 "more than fill the box");
    add_kill_rows(table);
    return table.check(check_flow).build();
  }();
  return kTable;
}

}  // namespace truestep::grid_fluid
