#include "engine/systems/fem/fem_def.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/fem/fem_choice.h"
#include "engine/systems/fem/fem_tables.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

const std::vector<std::string>& cell_names() {
  static const std::vector<std::string> kCells{"auto", "tri3",  "tri6", "quad4", "quad9",
                                               "tet4", "tet10", "hex8", "hex27"};
  return kCells;
}

ElementKind kind_of(Cell cell) {
  return static_cast<ElementKind>(static_cast<uint8_t>(cell) - 1);
}
Cell cell_of(const FemDef& d) {
  return d.element != Cell::automatic ? d.element : choose_cell(d).cell;
}
bool in_plane(const FemDef& d) {
  return d.plane <= Plane::stress && element_of(kind_of(cell_of(d))).dimension == 2;
}
bool is_sheet(const FemDef& d) {
  return d.plane >= Plane::membrane && element_of(kind_of(cell_of(d))).dimension == 2;
}

std::vector<std::string> set_names(const FemDef& d) {
  std::vector<std::string> out;
  if (d.block || d.quad) out = {"x0", "x1", "y0", "y1", "bottom", "top"};
  if (d.block) out.insert(out.end(), {"z0", "z1"});
  for (size_t k = 0; d.mesh && k < d.mesh->sets.size(); ++k) out.push_back(d.mesh->sets[k].name);
  out.insert(out.end(), {"border", "all"});
  for (const SetDef& s : d.sets) out.push_back(s.name);
  return out;
}

std::unique_ptr<Region> region_of(const FemDef& d) {
  if (!d.fill) return nullptr;
  if (d.fill->ball) return ball_region(d.fill->ball->center, d.fill->ball->radius);
  if (d.fill->cylinder)
    return cylinder_region(d.fill->cylinder->from, d.fill->cylinder->to, d.fill->cylinder->radius);
  return surface_region(d.fill->surface->vertices, mesh_triangles(*d.fill->surface));
}

FemCounts fem_counts(const FemDef& d) {
  const Element& kind = element_of(kind_of(cell_of(d)));
  const bool second = kind.size() > kind.corners;
  double corners = 0, cells = 0;
  if (d.block || d.quad) {
    const double nx = d.block ? d.block->cells_x : d.quad->cells_x,
                 ny = d.block ? d.block->cells_y : d.quad->cells_y, nz = d.block ? d.block->cells_z : 0;
    const double boxes = nx * ny * std::max(nz, 1.0);
    cells = boxes * (!kind.simplex ? 1 : d.block ? 5 : 2);
    corners = (nx + 1) * (ny + 1) * (nz + 1);
    if (second && !(kind.simplex && d.block)) corners = (2 * nx + 1) * (2 * ny + 1) * (2 * nz + 1);
    // Tetrahedra have a node per edge: three edges along the lattice and three diagonals per box.
    if (second && kind.simplex && d.block) corners += 6 * boxes + 2 * (nx * ny + ny * nz + nx * nz);
  } else if (d.fill) {
    const StuffingSize size = stuffing_size(region_of(d)->volume(), d.fill->spacing);
    cells = size.tetrahedra, corners = size.nodes;
    if (second) corners += 1.4 * cells;
  } else if (d.mesh) {
    cells = static_cast<double>(d.mesh->cells.size()) / kind.corners;
    corners = static_cast<double>(d.mesh->vertices.size());
    // Edges per corner, and faces and cells where elements have nodes in them.
    if (second)
      corners +=
          kind.dimension == 2 ? (kind.simplex ? 1.6 : 1.1) * cells + corners : 1.4 * cells + 4 * corners;
  }
  // Neighbours of a node inside a large lattice.
  const double each = kind.dimension == 2 ? (second ? (kind.simplex ? 12 : 16) : (kind.simplex ? 7 : 9))
                                          : (second ? (kind.simplex ? 27 : 64) : (kind.simplex ? 14 : 27));
  const double across = d.plane == Plane::shell ? 1.8 : 1;  // edges couple the nodes on both their sides
  const double copies = std::max<double>(1, static_cast<double>(d.copies.size()));
  return {copies * corners, copies * cells, copies * each * across * corners};
}

const DefTable& fem_table() {
  static const DefTable t = [] {
    using D = FemDef;
    TableOf<D> table("elastic bodies of finite elements, in space and in the plane");
    table
        .object("block", &D::block, soft_block_shape_table(),
                "a box; its sides are the sets x0, x1, y0, y1, z0, z1")
        .object("quad", &D::quad, quad_table(), "a plane body with four corners; sides x0, x1, y0, y1")
        .object("mesh", &D::mesh, cells_table(), "elements of any kind")
        .object("fill", &D::fill, fill_table(),
                "a ball, a cylinder or the inside of a surface, filled with tetrahedra")
        .objects("copies", &D::copies, copy_table(), {0, 10000},
                 "copies of the shape, each rotated and translated; absent: one as given")
        .choice(
            "element", &D::element, cell_names(),
            "kind of the elements; of second order: tri6, quad9, tet10, hex27; auto: of second order where "
            "that is needed and cheap; the plan says which and why")
        .choice("plane", &D::plane, {"strain", "stress", "membrane", "shell"},
                "plane strain (constant thickness) or plane stress; membrane: a sheet in space that resists "
                "stretching; shell: also bending, with tri6")
        .number("plane_thickness", &D::plane_thickness, "m", above(0), "of a plane body or a sheet")
        .objects("sets", &D::sets, set_table(), {0, 1000},
                 "sets of nodes, in addition to the sides, border and all")
        .choice("material", &D::material,
                {"linear", "corotated", "st_venant_kirchhoff", "neo_hookean", "stable_neo_hookean",
                 "mooney_rivlin"},
                "elastic law; linear: small strains and small rotations only")
        .number("youngs_modulus", &D::youngs_modulus, "Pa", above(0), "E")
        .number("poisson_ratio", &D::poisson_ratio, "1", {.min = -1, .max = 0.5, .ends = Limits::Ends::open},
                "nu")
        .number("density", &D::density, "kg/m^3", above(0), "at rest")
        .number("second_share", &D::second_share, "1", between(0, 1), "mooney_rivlin: c2 / (c1 + c2)")
        .choice("volume", &D::volume, {"auto", "pointwise", "mean"},
                "mean: an element resists the change of its volume as a whole, so that nearly incompressible "
                "bodies do not lock; auto: mean from a Poisson's ratio of 0.45 on, where that applies")
        .choice("incompatible_modes", &D::incompatible_modes, {"none", "wilson"},
                "wilson: bending modes within hex8 and quad4, so that they are not too stiff in bending")
        .number("damping", &D::damping, "1/s", at_least(0), "force -damping * mass * v")
        .vector("velocity", &D::velocity, "m/s", any(), "initial, of every node that is not fixed")
        .integers("pins", &D::pins, at_least(0), {}, "indices of fixed nodes")
        .texts("pinned", &D::pinned, {}, "sets of fixed nodes: x0, bottom, border ...")
        .texts("clamped", &D::clamped, {},
               "sets of a shell that are fixed and whose edges along the rim keep their direction")
        .objects("holds", &D::holds, hold_table(), {0, 1000},
                 "prescribed displacements, which may vary in time")
        .objects("loads", &D::loads, load_table(), {0, 1000},
                 "forces, tractions and pressures on the surface")
        .number("load_time", &D::load_time, "s", at_least(0),
                "over which loads, and gravity in quasi-static motion, grow linearly from 0")
        .choice("motion", &D::motion, {"dynamic", "quasi_static"},
                "quasi_static: every step ends in equilibrium, found by Newton's method with line search")
        .integer("modes", &D::modes, between(0, 64),
                 "natural frequencies of the body at rest to observe, lowest first")
        .choice("contact", &D::contact, {"nodes", "barrier"},
                "nodes: colliders keep the nodes out; barrier: every step of implicit Euler keeps the "
                "surface from touching colliders or itself")
        .number("contact_distance", &D::contact_distance, "m", at_least(0),
                "kept from every obstacle, default 0; with a barrier where it begins to push, default a "
                "thousandth of the body's size")
        .number("restitution", &D::restitution, "1", between(0, 1),
                "on any collider, instead of the collider's own")
        .number("friction", &D::friction, "1", at_least(0),
                "Coulomb's coefficient on colliders; absent: each collider's own");
    add_collider_rows(table, &D::colliders);
    add_integrator_rows(table);
    return table.check(check_fem).build();
  }();
  return t;
}

}  // namespace truestep::fem
