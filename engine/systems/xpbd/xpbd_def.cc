#include "engine/systems/xpbd/xpbd_def.h"

#include <algorithm>

namespace truestep::xpbd {

namespace {

const DefTable& load_table() {
  static const DefTable t = TableOf<LoadDef>("mass added to a point")
                                .integer("point", &LoadDef::point, at_least(0), "index of the point")
                                .required()
                                .number("mass", &LoadDef::mass, "kg", above(0), "added to the point's own")
                                .required()
                                .build();
  return t;
}

std::vector<std::string> pin_names(const XpbdDef& d) {
  if (d.cloth_grid) {
    return {"corners", "corner_00", "corner_10", "corner_01", "corner_11", "edge_u0",
            "edge_u1", "edge_v0",   "edge_v1",   "border",    "first",     "last"};
  }
  if (d.rope || d.helix) return {"first", "last", "ends"};
  if (d.hair) return {"roots"};
  if (d.block) return {"bottom", "top", "x0", "x1", "z0", "z1"};
  return {"first", "last"};
}

void check_rigidities(const XpbdDef& d, const DefTable::Report& report) {
  if (d.bending_rigidity > 0 && !d.rope && !d.helix && !d.hair) {
    report("/bending_rigidity", "only for ropes and hair; for cloth give flexural_rigidity");
  }
  if (d.flexural_rigidity > 0 && !d.cloth_grid && !d.mesh) {
    report("/flexural_rigidity", "only for cloth; for ropes and hair give bending_rigidity");
  }
  if (d.youngs_modulus && d.mesh && !is_membrane(d)) {
    report("/youngs_modulus",
           "only for ropes, hair, cloth grids, blocks and membranes; for a mesh of links give stiffness");
  }
  if (d.youngs_modulus && !d.block && !(d.thickness > 0))
    report("/youngs_modulus", "needs a thickness above 0");
  if (!d.cloth_grid || (!(d.flexural_rigidity > 0) && (!d.youngs_modulus || is_membrane(d)))) return;
  if (const char* fault = plate_fault(*d.cloth_grid)) {
    report(d.youngs_modulus && !is_membrane(d) ? "/youngs_modulus" : "/flexural_rigidity", fault);
  }
}

/// m, between neighbours; the mean for a mesh.
double spacing(const XpbdDef& d) {
  if (d.rope) return rope_link(*d.rope);
  if (d.helix) return helix_link(*d.helix);
  if (d.hair) return d.hair->length / d.hair->links;
  if (d.cloth_grid) {
    return std::min(norm(d.cloth_grid->edge_u) / (d.cloth_grid->nx - 1.0),
                    norm(d.cloth_grid->edge_v) / (d.cloth_grid->ny - 1.0));
  }
  if (d.block) {
    const Vec3 s = d.block->size;
    return std::min({s.x / d.block->cells_x, s.y / d.block->cells_y, s.z / d.block->cells_z});
  }
  double sum = 0;
  size_t count = 0;
  const auto& corners = d.mesh->triangles;
  // Indices out of range have an error of their own.
  const auto place = [&](size_t k) {
    const auto i = static_cast<size_t>(corners[k]);
    return i < d.mesh->vertices.size() ? d.mesh->vertices[i] : Vec3{};
  };
  for (size_t k = 0; k + 2 < corners.size(); k += 3) {
    sum += norm(place(k + 1) - place(k)) + norm(place(k + 2) - place(k + 1)) + norm(place(k) - place(k + 2));
    count += 3;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

void check_self_collision(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.self_collision) return;
  if (!(d.thickness > 0)) report("/self_collision", "needs a thickness above 0");
  // Points this close along the sheet would be pushed apart for ever.
  const double most = spacing(d);
  if (d.thickness <= most) return;
  report("/thickness", "self_collision needs at most the distance between neighbours, " +
                           std::to_string(most) + " m: use fewer points or a smaller thickness");
}

/// Only links can be solved simultaneously.
void check_sweep(const XpbdDef& d, const DefTable::Report& report) {
  if (!is_simultaneous(d.sweep)) return;
  const char* other = d.rod                                               ? "rods"
                      : d.bending_rigidity > 0 || d.flexural_rigidity > 0 ? "bending"
                      : d.matching                                        ? "shape matching"
                      : d.block                                           ? "volumes"
                      : is_membrane(d)                                    ? "membranes"
                      : d.tear                                            ? "what tears"
                      : d.internal_damping > 0                            ? "internal_damping"
                      : d.tether_slack                                    ? "tethers"
                                                                          : nullptr;
  if (other)
    report("/sweep", std::string("jacobi and chebyshev solve only links, not ") + other + ": use chains");
}

void check_def(const XpbdDef& d, const DefTable::Report& report) {
  const int shapes = d.rope.has_value() + d.helix.has_value() + d.hair.has_value() +
                     d.cloth_grid.has_value() + d.mesh.has_value() + d.block.has_value();
  if (shapes != 1) {
    return report("", "give exactly one of rope, helix, hair, cloth_grid, mesh and block, not " +
                          std::to_string(shapes));
  }
  check_rigidities(d, report);
  check_rod(d, report);
  check_tear(d, report);
  check_soft(d, report);
  check_sheet(d, report);
  check_self_collision(d, report);
  check_sweep(d, report);
  if (d.scheme == Scheme::xpbd && d.projection != 1) {
    report("/projection", "only for scheme pbd; with xpbd give stiffness");
  }
  const XpbdCounts counts = xpbd_counts(d);
  if (counts.points > 1e7) report("", "more than ten million points");
  const auto check_row = [&](const std::string& at, int64_t row) {
    if (static_cast<double>(row) < counts.points) return;
    report(at, "there are only " + std::to_string(static_cast<int64_t>(counts.points)) + " points");
  };
  for (size_t i = 0; i < d.pins.size(); ++i) check_row("/pins/" + std::to_string(i), d.pins[i]);
  for (size_t i = 0; i < d.attachments.size(); ++i) {
    check_row("/attachments/" + std::to_string(i) + "/point", d.attachments[i].point);
  }
  for (size_t i = 0; i < d.loads.size(); ++i) {
    check_row("/loads/" + std::to_string(i) + "/point", d.loads[i].point);
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

XpbdCounts xpbd_counts(const XpbdDef& d) {
  if (d.rope)
    return {d.rope->links + 1.0, d.rope->links + 0.0, d.bending_rigidity > 0 ? d.rope->links : 0.0, 0};
  if (d.helix) {
    return {d.helix->links + 1.0, d.helix->links + 0.0, d.bending_rigidity > 0 ? d.helix->links : 0.0, 0};
  }
  if (d.hair) {
    const double links = static_cast<double>(d.hair->strands) * d.hair->links;
    return {links + d.hair->strands, links, d.bending_rigidity > 0 ? links : 0, 0};
  }
  if (d.cloth_grid) {
    const double points = static_cast<double>(d.cloth_grid->nx) * d.cloth_grid->ny;
    const double diagonals = d.cloth_grid->shear == ShearSprings::both  ? 2
                             : d.cloth_grid->shear == ShearSprings::one ? 1
                                                                        : 0;
    return {points, points * (2 + diagonals), d.flexural_rigidity > 0 ? 4 * points : 0, 0};
  }
  const double copies = std::max<double>(1, static_cast<double>(d.copies.size()));
  if (d.mesh) {
    const double triangles = copies * static_cast<double>(d.mesh->triangles.size()) / 3;
    return {copies * static_cast<double>(d.mesh->vertices.size()), 3 * triangles,
            d.flexural_rigidity > 0 ? 1.5 * triangles : 0, 0};
  }
  if (d.block) {
    const SoftBlockShape& b = *d.block;
    const double cells = static_cast<double>(b.cells_x) * b.cells_y * b.cells_z;
    const double points = (b.cells_x + 1.0) * (b.cells_y + 1.0) * (b.cells_z + 1.0);
    return {copies * points, copies * 6 * points, 0, copies * 5 * cells};
  }
  return {};
}

const DefTable& xpbd_table() {
  static const DefTable t = [] {
    using D = XpbdDef;
    TableOf<D> table("cloth, ropes, hair and soft blocks by position-based dynamics");
    table.object("rope", &D::rope, rope_shape_table(), "a rope")
        .object("helix", &D::helix, helix_shape_table(), "a coil, an arc or a ring")
        .object("hair", &D::hair, hair_shape_table(), "a bundle of hair, held at its roots")
        .object("cloth_grid", &D::cloth_grid, cloth_grid_shape_table(), "a rectangular cloth")
        .object("mesh", &D::mesh, mesh_shape_table(), "a cloth of any form")
        .object("block", &D::block, soft_block_shape_table(), "a soft box of tetrahedra")
        .number("mass", &D::mass, "kg", above(0), "of every point (unless density is given)")
        .number(
            "density", &D::density, "", above(0),
            "kg per metre of rope or hair, square metre of cloth, cubic metre of a block; instead of mass")
        .objects("loads", &D::loads, load_table(), {0, 100'000}, "masses attached to points")
        .number("stiffness", &D::stiffness, "N/m", above(0), "of a link between neighbours")
        .number("shear_stiffness", &D::shear_stiffness, "N/m", at_least(0),
                "of a diagonal link of a cloth grid; 0: no diagonal links")
        .number("youngs_modulus", &D::youngs_modulus, "Pa", above(0),
                "instead of both: of a rope or hair of round section, of a cloth grid with Poisson ratio 1/3 "
                "(thickness is used); of a block, which is then stable Neo-Hookean")
        .number("poisson_ratio", &D::poisson_ratio, "1", between(-0.9, 0.4999),
                "of a block with youngs_modulus and of a membrane; default 0.3")
        .choice("membrane", &D::membrane, {"links", "st_venant_kirchhoff", "neo_hookean"},
                "what resists stretching in cloth: links between points, or triangles of a material with "
                "youngs_modulus, poisson_ratio and thickness; with pbd st_venant_kirchhoff is strain-based "
                "dynamics, which has no modulus")
        .objects("attachments", &D::attachments, attachment_table(), {0, 100'000},
                 "springs from points to fixed positions; release ends them")
        .number("tether_slack", &D::tether_slack, "1", at_least(0),
                "long-range attachments: a free point stays within 1 + this times the rest length of the "
                "path of links to the nearest pinned point; absent: none")
        .object("rod", &D::rod, rod_table(),
                "makes rope, helix or hair Cosserat rods, which stretch, shear, bend and twist")
        .objects("copies", &D::copies, copy_table(), {0, 10'000},
                 "copies of the mesh or block instead of one; rows come body after body")
        .object("matching", &D::matching, match_table(),
                "shape matching of mesh or block, instead of links and volumes")
        .object("tear", &D::tear, tear_table(), "lets cloth tear: points split where links are overloaded")
        .number("bulk_modulus", &D::bulk_modulus, "Pa", above(0), "of a block: pressure per change of volume")
        .number("bending_rigidity", &D::bending_rigidity, "N m^2", at_least(0),
                "of a rope or hair: E I, moment per curvature; straight at rest")
        .number("flexural_rigidity", &D::flexural_rigidity, "N m", at_least(0),
                "of cloth: D = E t^3 / (12 (1 - nu^2)); at rest a grid is flat, a mesh as given")
        .number("rest_scale", &D::rest_scale, "1", above(0), "rest lengths are the initial ones times this")
        .number("damping", &D::damping, "N s/m", at_least(0), "viscous: force -damping * v on every point")
        .number("internal_damping", &D::internal_damping, "N s/m", at_least(0),
                "along the links only: it slows stretching, not swinging")
        .vector("velocity", &D::velocity, "m/s", any(), "initial, of every point that is not pinned")
        .integers("pins", &D::pins, at_least(0), {}, "indices of pinned points")
        .texts("pinned", &D::pinned, {},
               "names of pinned points: first, last, corners, edge_v1, roots, bottom ...")
        .vector("wind", &D::wind, "m/s", any(),
                "velocity of the air, 0 for still air: drag and lift on every triangle, drag on ropes and "
                "hair; absent: no air")
        .number("gust", &D::gust, "1", between(0, 1), "amplitude of gusts, as a fraction of the wind")
        .number("gust_period", &D::gust_period, "s", above(0), "period of gusts")
        .number("air_density", &D::air_density, "kg/m^3", at_least(0), "of the air, if there is wind")
        .number("drag_coefficient", &D::drag_coefficient, "1", at_least(0),
                "of the cloth's faces or the rope's cross-section")
        .vector("color", &D::color, "1", between(0, 1), "red, green, blue as a screen shows them")
        .number("thickness", &D::thickness, "m", at_least(0),
                "of the cloth, or diameter of the rope; points stay half of it away from obstacles")
        .boolean("self_collision", &D::self_collision,
                 "facets and edges are kept a thickness apart, however fast they meet")
        .number("self_friction", &D::self_friction, "1", at_least(0),
                "Coulomb's coefficient of the cloth on itself")
        .number("restitution", &D::restitution, "1", between(0, 1),
                "of these points on any collider, instead of the collider's own")
        .number("friction", &D::friction, "1", at_least(0),
                "Coulomb's coefficient on colliders; absent: each collider's own");
    add_collider_rows(table, &D::colliders);
    table
        .choice("scheme", &D::scheme, {"xpbd", "pbd"},
                "xpbd: stiffness in N/m, independent of the step; pbd: textbook projections, whose stiffness "
                "depends on steps and iterations")
        .choice("sweep", &D::sweep, {"chains", "links", "jacobi", "chebyshev"},
                "chains: links in line are solved together, which carries loads through a cloth in one "
                "sweep; links: one by one, also for chains with pbd; jacobi: all from the same positions; "
                "chebyshev: jacobi accelerated. The last two solve only links, in the given iterations")
        .choice("precision", &D::precision, {"f64", "f32"}, "of the numbers within a step")
        .integer("substeps", &D::substeps, between(1, 10'000),
                 "of a step; default for xpbd: 10 in 1/60 s, and more while tension would turn links too far "
                 "in one; for pbd 1")
        .integer(
            "iterations", &D::iterations, between(1, 10'000),
            "over all constraints per substep; default 1, or 20 for pbd and the sweeps jacobi and chebyshev")
        .number(
            "projection", &D::projection, "1", between(0, 1),
            "scheme pbd: share k of a correction that is applied: 1 - (1 - k)^(1/n) in each of n iterations");
    return table.check(check_def).build();
  }();
  return t;
}

}  // namespace truestep::xpbd
