#include "engine/systems/mass_spring/mass_spring_def.h"

#include <algorithm>

#include "engine/geometry/make/surface.h"

namespace truestep::mass_spring {

namespace {

const DefTable& free_spring_table() {
  static const DefTable t =
      TableOf<FreeSpring>("spring between two points")
          .integer("a", &FreeSpring::a, at_least(0), "index of one point")
          .required()
          .integer("b", &FreeSpring::b, at_least(0), "index of the other")
          .required()
          .number("stiffness", &FreeSpring::stiffness, "N/m", above(0), "absent: the system's")
          .number("rest_length", &FreeSpring::rest_length, "m", at_least(0), "absent: the initial distance")
          .build();
  return t;
}

const DefTable& free_table() {
  static const DefTable t =
      TableOf<FreeShape>("any points and springs")
          .vectors("points", &FreeShape::points, "m", any(), {1, 1'000'000}, "positions of the points")
          .required()
          .vectors("velocities", &FreeShape::velocities, "m/s", any(), {0, 1'000'000},
                   "one per point, or none")
          .numbers("masses", &FreeShape::masses, "kg", above(0), {0, 1'000'000}, "one per point, or none")
          .objects("springs", &FreeShape::springs, free_spring_table(), {0, 4'000'000}, "connections")
          .check([](const FreeShape& f, const DefTable::Report& report) {
            if (!f.masses.empty() && f.masses.size() != f.points.size()) {
              report("/masses", "there must be one mass per point");
            }
            if (!f.velocities.empty() && f.velocities.size() != f.points.size()) {
              report("/velocities", "there must be one velocity per point");
            }
            const auto n = static_cast<int64_t>(f.points.size());
            for (size_t i = 0; i < f.springs.size(); ++i) {
              const FreeSpring& s = f.springs[i];
              const std::string at = "/springs/" + std::to_string(i);
              if (s.a >= n) return report(at + "/a", "there is no such point");
              if (s.b >= n) return report(at + "/b", "there is no such point");
              if (s.a == s.b) return report(at, "a spring needs two different points");
            }
          })
          .build();
  return t;
}

/// Springs of zero length have no direction, triangles of zero area no mass; the bending at an edge of three
/// triangles is undefined.
void check_mesh(const MassSpringDef& d, const DefTable::Report& report) {
  const auto fault = [&](const ClothFault& f, const char* more) {
    report("/mesh/triangles/" + std::to_string(f.corner), f.what + more);
  };
  if (const auto flat = flat_triangle(*d.mesh)) return fault(*flat, "");
  if (!(d.bending_stiffness > 0)) return;
  if (const auto crowded = crowded_edge(*d.mesh)) {
    fault(*crowded, ", where bending is undefined: split the mesh there or leave bending_stiffness out");
  }
}

void check_def(const MassSpringDef& d, const DefTable::Report& report) {
  const int shapes = d.rope.has_value() + d.hair.has_value() + d.cloth_grid.has_value() + d.mesh.has_value() +
                     d.free.has_value();
  if (shapes != 1) {
    return report("",
                  "give exactly one of rope, hair, cloth_grid, mesh and free, not " + std::to_string(shapes));
  }
  if (d.bending_rigidity > 0 && !d.rope && !d.hair) {
    report("/bending_rigidity", "only for ropes and hair; for a cloth grid give flexural_rigidity");
  }
  if (d.flexural_rigidity > 0) {
    if (!d.cloth_grid) {
      report("/flexural_rigidity", "only for a cloth grid; for ropes and hair give bending_rigidity");
    } else if (const char* fault = plate_fault(*d.cloth_grid)) {
      report("/flexural_rigidity", fault);
    }
  }
  if (d.mesh) check_mesh(d, report);
  const MassSpringCounts counts = mass_spring_counts(d);
  if (counts.points > 1e7) report("", "more than ten million points");
  for (size_t i = 0; i < d.pins.size(); ++i) {
    if (static_cast<double>(d.pins[i]) < counts.points) continue;
    report("/pins/" + std::to_string(i),
           "there are only " + std::to_string(static_cast<int64_t>(counts.points)) + " points");
  }
  const std::vector<std::string> names = pin_names(d);
  for (size_t i = 0; i < d.pinned.size(); ++i) {
    if (std::find(names.begin(), names.end(), d.pinned[i]) != names.end()) continue;
    std::string allowed;
    for (const std::string& n : names) allowed += (allowed.empty() ? "" : ", ") + n;
    report("/pinned/" + std::to_string(i), "this shape can be pinned at: " + allowed);
  }
}

}  // namespace

std::vector<std::string> pin_names(const MassSpringDef& d) {
  if (d.cloth_grid) {
    return {"corners", "corner_00", "corner_10", "corner_01", "corner_11", "edge_u0",
            "edge_u1", "edge_v0",   "edge_v1",   "border",    "first",     "last"};
  }
  if (d.rope) return {"first", "last", "ends"};
  if (d.hair) return {"roots"};
  return {"first", "last"};
}

MassSpringCounts mass_spring_counts(const MassSpringDef& d) {
  const bool bends = d.bending_stiffness > 0;
  if (d.rope) return {d.rope->links + 1.0, d.rope->links * (bends ? 2.0 : 1.0), 0};
  if (d.hair) {
    const double strands = d.hair->strands;
    return {strands * (d.hair->links + 1.0), strands * d.hair->links * (bends ? 2.0 : 1.0), 0};
  }
  if (d.cloth_grid) {
    const double points = static_cast<double>(d.cloth_grid->nx) * d.cloth_grid->ny;
    const double diagonals = d.cloth_grid->shear == ShearSprings::both  ? 2
                             : d.cloth_grid->shear == ShearSprings::one ? 1
                                                                        : 0;
    return {points, points * (2 + diagonals + (bends ? 2 : 0)), 2 * points};
  }
  if (d.mesh) {
    const double triangles = static_cast<double>(d.mesh->triangles.size()) / 3;
    return {static_cast<double>(d.mesh->vertices.size()), triangles * (bends ? 6.0 : 3.0), triangles};
  }
  if (d.free)
    return {static_cast<double>(d.free->points.size()), static_cast<double>(d.free->springs.size()), 0};
  return {};
}

const DefTable& mass_spring_table() {
  static const DefTable t = [] {
    using D = MassSpringDef;
    TableOf<D> table("points joined by springs: ropes, hair, cloth on a grid or a mesh, free networks");
    table.object("rope", &D::rope, rope_shape_table(), "a rope")
        .object("hair", &D::hair, hair_shape_table(), "a bundle of hair, held at its roots")
        .object("cloth_grid", &D::cloth_grid, cloth_grid_shape_table(), "a rectangular cloth")
        .object("mesh", &D::mesh, mesh_shape_table(), "a cloth of any form")
        .object("free", &D::free, free_table(), "points and springs one by one")
        .number("mass", &D::mass, "kg", above(0), "of every point (unless density or masses are given)")
        .number("density", &D::density, "", above(0),
                "kg per metre of rope or hair, per square metre of cloth; instead of mass")
        .number("stiffness", &D::stiffness, "N/m", at_least(0), "of a structural spring")
        .number("shear_stiffness", &D::shear_stiffness, "N/m", at_least(0),
                "of a diagonal spring of a cloth grid; 0: no diagonal springs")
        .number("bending_stiffness", &D::bending_stiffness, "N/m", at_least(0),
                "of a spring that skips a point or crosses an edge; 0: none. It resists sharp bends but "
                "hardly slight ones: for a stiffness against curvature use one of the next two")
        .number("bending_rigidity", &D::bending_rigidity, "N m^2", at_least(0),
                "of a rope or hair: E I, moment per curvature; straight at rest")
        .number("flexural_rigidity", &D::flexural_rigidity, "N m", at_least(0),
                "of a cloth grid with right angles: D = E t^3 / (12 (1 - nu^2)), moment per width and "
                "curvature of a "
                "plate with Poisson ratio 1/3; flat at rest")
        .number("rest_scale", &D::rest_scale, "1", at_least(0),
                "rest lengths are the initial ones times this; 0: springs of zero rest length")
        .number("damping", &D::damping, "N s/m", at_least(0), "viscous: force -damping * v on every point")
        .number("internal_damping", &D::internal_damping, "N s/m", at_least(0),
                "along the springs only: it slows stretching, not swinging")
        .vector("velocity", &D::velocity, "m/s", any(), "initial, of every point that is not pinned")
        .integers("pins", &D::pins, at_least(0), {}, "indices of pinned points")
        .texts("pinned", &D::pinned, {}, "names of pinned points: first, last, corners, edge_v1, roots ...")
        .vector("wind", &D::wind, "m/s", any(), "velocity of the air; absent: no air")
        .number("gust", &D::gust, "1", between(0, 1), "amplitude of gusts, as a fraction of the wind")
        .number("gust_period", &D::gust_period, "s", above(0), "period of gusts")
        .number("air_density", &D::air_density, "kg/m^3", at_least(0), "of the air, if there is wind")
        .number("drag_coefficient", &D::drag_coefficient, "1", at_least(0),
                "of the cloth's faces or the rope's cross-section")
        .vector("color", &D::color, "1", between(0, 1), "red, green, blue as a screen shows them")
        .number("thickness", &D::thickness, "m", at_least(0),
                "diameter of the rope for the wind; points stay half of it away from obstacles")
        .number("restitution", &D::restitution, "1", between(0, 1),
                "of these points on any collider, instead of the collider's own")
        .number("friction", &D::friction, "1", at_least(0),
                "Coulomb's coefficient on colliders; absent: each collider's own");
    add_collider_rows(table, &D::colliders);
    return add_integrator_rows(table).check(check_def).build();
  }();
  return t;
}

}  // namespace truestep::mass_spring
