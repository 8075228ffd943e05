#include "engine/systems/fem/fem_def.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/fem/bending.h"
#include "engine/systems/fem/fem_tables.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

namespace {

const std::vector<std::string> kCells{"auto", "tri3",  "tri6", "quad4", "quad9",
                                      "tet4", "tet10", "hex8", "hex27"};

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

using Report = DefTable::Report;

constexpr const char* kForms[] = {"", "triangles: tri3, tri6", "quadrangles: quad4, quad9",
                                  "tetrahedra: tet4, tet10", "hexahedra: hex8, hex27"};
Form form_of(const Element& kind) {
  if (kind.dimension == 2) return kind.simplex ? Form::triangles : Form::quadrangles;
  return kind.simplex ? Form::tetrahedra : Form::hexahedra;
}

void check_sheet(const FemDef& d, const Report& report) {
  if (d.plane == Plane::shell && cell_of(d) != Cell::tri6)
    report("/element", "a shell is made of tri6: a membrane may be of others");
  if (d.plane == Plane::membrane && !d.clamped.empty())
    report("/clamped", "a membrane has no direction to be held: take plane shell, or pinned");
  if (d.material == Law::linear)
    report("/material", "a sheet turns in space: take corotated, the same for small strains");
  if (d.volume == Volume::mean)
    report("/volume", "a sheet gets thinner as it is stretched and nothing locks: leave it pointwise");
  if (d.contact == Meeting::barrier) report("/contact", "sheets have no barrier");
}

void check_element(const FemDef& d, const Report& report) {
  const Element& kind = element_of(kind_of(cell_of(d)));
  if (d.block && kind.dimension == 2) report("/element", "a block is made of tet4, tet10, hex8 or hex27");
  if (d.fill && !(kind.simplex && kind.dimension == 3))
    report("/element", "a region is filled with tet4 or tet10");
  if (d.quad && kind.dimension == 3) report("/element", "a quad is made of tri3, tri6, quad4 or quad9");
  if (d.mesh && d.mesh->form == Form::as_element && d.element == Cell::automatic)
    report("/element", "name the element that a mesh is made of: " + listed(kCells));
  if (d.mesh && d.mesh->form != Form::as_element && form_of(kind) != d.mesh->form)
    report("/element", std::string("the mesh is made of ") + kForms[static_cast<size_t>(d.mesh->form)]);
  if (kind.dimension == 3 && d.plane != Plane::strain)
    report("/plane", "only bodies of tri3, tri6, quad4 or quad9 are plane or sheets");
  if (is_sheet(d)) check_sheet(d, report);
  if (d.incompatible_modes == Incompatible::wilson) {
    const bool first = !kind.simplex && kind.size() == kind.corners;
    if (!first || is_sheet(d))
      report("/incompatible_modes", "those of hex8 and of plane quad4: other elements bend without them");
    if (d.volume == Volume::mean)
      report("/incompatible_modes", "with volume mean there are none: leave volume pointwise");
  }
  if (d.volume != Volume::mean) return;
  if (kind.points.size() == 1) {
    report("/volume", "an element with one point has no other mean: take tri6, quad4, tet10, hex8 ...");
  }
  if (kind.dimension == 2 && d.plane == Plane::stress) {
    report("/volume", "in plane stress the thickness gives way and nothing locks: leave it pointwise");
  }
}

void check_material(const FemDef& d, const Report& report) {
  if (d.second_share > 0 && d.material != Law::mooney_rivlin) {
    return report("/second_share", "only the material mooney_rivlin has one");
  }
  const Material m = material_of(d.material, d.youngs_modulus, d.poisson_ratio, d.second_share);
  if (d.material == Law::mooney_rivlin && m.lambda < 2 * m.mu * d.second_share) {
    report("/poisson_ratio",
           "too small for this second_share: lambda must be at least 4 c2 = 2 mu second_share");
  }
  if (d.material == Law::stable_neo_hookean && m.lambda + 5.0 / 6 * m.mu <= 0) {
    report("/poisson_ratio", "too small for this material: lambda + 5/6 mu must be above 0");
  }
}

bool check_rows(const FemDef& d, const Report& report) {
  double vertices = d.fill && !d.pins.empty() ? static_cast<double>(build_mesh(d).x.size())
                    : d.mesh
                        ? static_cast<double>(d.mesh->vertices.size() * std::max<size_t>(1, d.copies.size()))
                        : fem_counts(d).nodes;
  bool good = true;
  const auto check = [&](const std::vector<int64_t>& rows, const std::string& at) {
    for (size_t i = 0; i < rows.size(); ++i) {
      if (static_cast<double>(rows[i]) < vertices) continue;
      report(at + "/" + std::to_string(i), "there are only " +
                                               std::to_string(static_cast<int64_t>(vertices)) +
                                               (d.mesh ? " vertices" : " nodes"));
      good = false;
      return;
    }
  };
  check(d.pins, "/pins");
  for (size_t k = 0; k < d.sets.size(); ++k)
    check(d.sets[k].points, "/sets/" + std::to_string(k) + "/points");
  if (!d.mesh) return good;
  vertices = static_cast<double>(d.mesh->vertices.size());
  check(d.mesh->cells, "/mesh/cells");
  for (size_t k = 0; k < d.mesh->sets.size(); ++k)
    check(d.mesh->sets[k].points, "/mesh/sets/" + std::to_string(k) + "/points");
  return good;
}

void check_cells(const FemDef& d, const Report& report) {
  const Element& kind = element_of(kind_of(cell_of(d)));
  if (d.mesh->cells.size() % kind.corners != 0) {
    return report("/mesh/cells", std::string(kind.name) + " has " + std::to_string(kind.corners) +
                                     " corners: their number is no multiple of that");
  }
  if (in_plane(d)) {
    for (size_t i = 0; i < d.mesh->vertices.size(); ++i) {
      if (d.mesh->vertices[i].z == 0) continue;
      return report("/mesh/vertices/" + std::to_string(i), "a plane body lies in z = 0");
    }
  }
  const Mesh mesh = build_mesh(d);
  const size_t bad = first_bad_cell(mesh);
  if (bad != static_cast<size_t>(-1)) {
    report(
        "/mesh/cells/" + std::to_string(bad * kind.corners),
        "element " + std::to_string(bad) + " is flat or turned inside out: number its corners as VTK does");
  }
  if (const auto crowded = first_crowded_face(mesh)) {
    return report("/mesh/cells/" + std::to_string((*crowded)[2] * kind.corners),
                  "elements " + std::to_string((*crowded)[0]) + ", " + std::to_string((*crowded)[1]) +
                      " and " + std::to_string((*crowded)[2]) + " share " +
                      (kind.dimension == 2 ? "an edge" : "a face") + ": two can");
  }
  if (const auto fold = d.plane == Plane::shell ? first_fold(mesh) : std::nullopt) {
    return report("/mesh/cells/" + std::to_string((*fold)[1] * kind.corners),
                  "elements " + std::to_string((*fold)[0]) + " and " + std::to_string((*fold)[1]) +
                      " lie on each other: a shell may be bent at an edge, not folded flat");
  }
  std::vector<uint8_t> used(mesh.x.size(), 0);
  for (const uint32_t p : mesh.nodes) used[p] = 1;
  for (size_t p = 0; p < used.size(); ++p) {
    if (used[p]) continue;
    return report("/mesh/vertices/" + std::to_string(p), "no element has this vertex: it would have no mass");
  }
}

void check_names(const FemDef& d, const Report& report) {
  const std::vector<std::string> names = set_names(d);
  for (size_t k = 0; k < names.size(); ++k) {
    const size_t own = names.size() - d.sets.size();
    if (std::find(names.begin(), names.begin() + static_cast<ptrdiff_t>(k), names[k]) ==
        names.begin() + static_cast<ptrdiff_t>(k))
      continue;
    report(k >= own ? "/sets/" + std::to_string(k - own) + "/name" : "/mesh/sets",
           "there is another set named \"" + names[k] + '"');
  }
  const auto check = [&](const std::string& at, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      report(at, "the sets are: " + listed(names));
  };
  for (size_t k = 0; k < d.pinned.size(); ++k) check("/pinned/" + std::to_string(k), d.pinned[k]);
  for (size_t k = 0; k < d.clamped.size(); ++k) check("/clamped/" + std::to_string(k), d.clamped[k]);
  for (size_t k = 0; k < d.holds.size(); ++k) check("/holds/" + std::to_string(k) + "/on", d.holds[k].on);
  for (size_t k = 0; k < d.loads.size(); ++k) {
    const LoadDef& l = d.loads[k];
    const std::string at = "/loads/" + std::to_string(k);
    check(at + "/on", l.on);
    const bool traction = l.x || l.y || l.z;
    if (l.force.has_value() + traction + l.pressure.has_value() != 1) {
      report(at, "give exactly one of force, pressure and a traction (x, y, z)");
    }
    const bool across = (l.force && l.force->z != 0) || l.z;
    if (in_plane(d) && across) report(at, "a plane body takes no force along z");
  }
  for (size_t k = 0; k < d.holds.size(); ++k) {
    if (in_plane(d) && d.holds[k].z)
      report("/holds/" + std::to_string(k) + "/z", "a plane body stays in z = 0");
  }
}

bool check_fill(const FillShape& f, const Report& report) {
  const int regions = f.ball.has_value() + f.cylinder.has_value() + f.surface.has_value();
  if (regions != 1) {
    report("/fill", "give exactly one of ball, cylinder and surface, not " + std::to_string(regions));
    return false;
  }
  if (f.surface) {
    if (const auto fault = surface_fault(mesh_triangles(*f.surface))) {
      report("/fill/surface/triangles/" + std::to_string(3 * fault->triangle), fault->what);
      return false;
    }
  }
  return true;
}

void check_copies(const FemDef& d, const Report& report) {
  for (size_t k = 0; k < d.copies.size() && in_plane(d); ++k) {
    const CopyDef& c = d.copies[k];
    const std::string at = "/copies/" + std::to_string(k);
    if (c.position.z != 0) report(at + "/position", "a plane body lies in z = 0");
    if (c.axis.x != 0 || c.axis.y != 0) report(at + "/axis", "a plane body turns about z");
    if (c.velocity.z != 0) report(at + "/velocity", "a plane body stays in z = 0");
  }
}

void check_barrier(const FemDef& d, const Report& report) {
  if (d.contact != Meeting::barrier) return;
  if (in_plane(d)) report("/contact", "plane bodies have no barrier");
  if (d.motion == Motion::quasi_static) report("/contact", "a barrier is part of a dynamic step");
  if (!d.integrator.empty())
    report("/integrator", "with contact barrier the step is one of implicit Euler: leave it out");
  if (d.restitution > 0) report("/restitution", "a barrier gives back what the body does: leave it out");
  if (d.contact_distance && !(*d.contact_distance > 0))
    report("/contact_distance", "a barrier begins at some distance: above 0");
  for (size_t k = 0; k < d.loads.size(); ++k) {
    if (d.loads[k].pressure)
      report("/loads/" + std::to_string(k) + "/pressure",
             "a pressure has no potential, which a barrier needs: take a force or a traction");
  }
  for (size_t k = 0; k < d.holds.size(); ++k) {
    const HoldDef& h = d.holds[k];
    const std::pair<const char*, const std::optional<std::string>*> parts[] = {
        {"/x", &h.x}, {"/y", &h.y}, {"/z", &h.z}};
    const auto given =
        std::count_if(std::begin(parts), std::end(parts), [](auto& p) { return p.second->has_value(); });
    for (const auto& [name, text] : parts) {
      if (given == 3 || !*text || **text == "0") continue;
      report("/holds/" + std::to_string(k) + name,
             "with contact barrier a hold prescribes x, y and z together, or keeps single ones at 0");
    }
  }
}

void check_def(const FemDef& d, const Report& report) {
  const int shapes = d.block.has_value() + d.quad.has_value() + d.mesh.has_value() + d.fill.has_value();
  if (shapes != 1) {
    return report("", "give exactly one of block, quad, mesh and fill, not " + std::to_string(shapes));
  }
  if (d.fill && !check_fill(*d.fill, report)) return;
  const FemCounts counts = fem_counts(d);
  if (counts.nodes > 2e6) {
    return report("", "more than two million nodes: fewer cells, or elements of first order");
  }
  check_element(d, report);
  check_material(d, report);
  if (!check_rows(d, report)) return;
  const bool known = d.mesh && (d.element != Cell::automatic || d.mesh->form != Form::as_element);
  if (known) check_cells(d, report);
  if (d.fill && build_mesh(d).cells() == 0)
    return report("/fill/spacing", "the region is finer than this: nothing of the lattice is left inside");
  check_names(d, report);
  check_copies(d, report);
  check_barrier(d, report);
  if (in_plane(d) && !d.colliders.empty()) report("/colliders", "plane bodies meet no colliders");
  if (in_plane(d) && d.velocity.z != 0) report("/velocity", "a plane body stays in z = 0");
  if (d.motion == Motion::quasi_static) {
    if (!d.integrator.empty())
      report("/integrator", "a quasi-static body is in equilibrium: it has no integrator");
    if (d.pins.empty() && d.pinned.empty() && d.clamped.empty() && d.holds.empty()) {
      report("/motion", "nothing holds the body: quasi-static motion needs pins, pinned or holds");
    }
    if (!d.colliders.empty()) report("/colliders", "quasi-static bodies meet no colliders");
    if (d.damping > 0) report("/damping", "a quasi-static body has no velocity");
  }
}

}  // namespace

ElementKind kind_of(Cell cell) {
  return static_cast<ElementKind>(static_cast<uint8_t>(cell) - 1);
}
Cell cell_of(const FemDef& d) {
  if (d.element != Cell::automatic) return d.element;
  if (d.mesh) {
    constexpr Cell kFirst[] = {Cell::quad4, Cell::tri3, Cell::quad4, Cell::tet4, Cell::hex8};
    return kFirst[static_cast<size_t>(d.mesh->form)];
  }
  return d.block ? Cell::hex8 : d.fill ? Cell::tet4 : Cell::quad4;
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
    // Of tetrahedra: a node an edge; three edges along the lattice and three diagonals a box.
    if (second && kind.simplex && d.block) corners += 6 * boxes + 2 * (nx * ny + ny * nz + nx * nz);
  } else if (d.fill) {
    const StuffingSize size = stuffing_size(region_of(d)->volume(), d.fill->spacing);
    cells = size.tetrahedra, corners = size.nodes;
    if (second) corners += 1.4 * cells;
  } else if (d.mesh) {
    cells = static_cast<double>(d.mesh->cells.size()) / kind.corners;
    corners = static_cast<double>(d.mesh->vertices.size());
    // Edges a corner, faces and cells where elements have nodes in them.
    if (second)
      corners +=
          kind.dimension == 2 ? (kind.simplex ? 1.6 : 1.1) * cells + corners : 1.4 * cells + 4 * corners;
  }
  // Neighbours of a node, inside a large lattice.
  const double each = kind.dimension == 2 ? (second ? (kind.simplex ? 12 : 16) : (kind.simplex ? 7 : 9))
                                          : (second ? (kind.simplex ? 27 : 64) : (kind.simplex ? 14 : 27));
  const double across = d.plane == Plane::shell ? 1.8 : 1;  // edges join the nodes of both their sides
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
        .object("mesh", &D::mesh, cells_table(), "elements of any form")
        .object("fill", &D::fill, fill_table(),
                "a ball, a cylinder or what a surface holds, filled with tetrahedra")
        .objects("copies", &D::copies, copy_table(), {0, 10000},
                 "bodies of this shape: each is turned and moved; absent: one as the shape says")
        .choice("element", &D::element, kCells,
                "kind of the elements; auto: hex8 of a block, quad4 of a quad; of second order: tri6, quad9, "
                "tet10, hex27")
        .choice("plane", &D::plane, {"strain", "stress", "membrane", "shell"},
                "what a plane body keeps across its plane: its thickness (strain), or no stress; membrane: a "
                "sheet in space that resists stretching; shell: and bending, of tri6")
        .number("plane_thickness", &D::plane_thickness, "m", above(0), "of a plane body or a sheet")
        .objects("sets", &D::sets, set_table(), {0, 1000},
                 "further sets of nodes, beside the sides, border and all")
        .choice("material", &D::material,
                {"linear", "corotated", "st_venant_kirchhoff", "neo_hookean", "stable_neo_hookean",
                 "mooney_rivlin"},
                "elastic law; linear: small strains and small rotations only")
        .number("youngs_modulus", &D::youngs_modulus, "Pa", above(0), "E")
        .number("poisson_ratio", &D::poisson_ratio, "1", {.min = -1, .max = 0.5, .ends = Limits::Ends::open},
                "nu; near 1/2 take volume mean")
        .number("density", &D::density, "kg/m^3", above(0), "at rest")
        .number("second_share", &D::second_share, "1", between(0, 1), "mooney_rivlin: c2 / (c1 + c2)")
        .choice("volume", &D::volume, {"pointwise", "mean"},
                "mean: an element resists the change of its volume as a whole, so that nearly incompressible "
                "bodies "
                "do not lock")
        .choice("incompatible_modes", &D::incompatible_modes, {"none", "wilson"},
                "wilson: hex8 and quad4 bend within themselves, so that they are not too stiff in bending")
        .number("damping", &D::damping, "1/s", at_least(0), "force -damping * mass * v")
        .vector("velocity", &D::velocity, "m/s", any(), "initial, of every node that is not held")
        .integers("pins", &D::pins, at_least(0), {}, "indices of nodes that are held")
        .texts("pinned", &D::pinned, {}, "sets that are held: x0, bottom, border ...")
        .texts("clamped", &D::clamped, {},
               "sets of a shell that are held, and whose edges along its rim keep their direction")
        .objects("holds", &D::holds, hold_table(), {0, 1000},
                 "displacements that are prescribed, also moving ones")
        .objects("loads", &D::loads, load_table(), {0, 1000},
                 "forces, tractions and pressures on the surface")
        .number("load_time", &D::load_time, "s", at_least(0),
                "loads, and gravity in quasi-static motion, grow evenly from 0 for so long")
        .choice("motion", &D::motion, {"dynamic", "quasi_static"},
                "quasi_static: every step ends in equilibrium, found by Newton's method with line search")
        .integer("modes", &D::modes, between(0, 64),
                 "natural frequencies of the body at rest to observe, lowest first")
        .choice(
            "contact", &D::contact, {"nodes", "barrier"},
            "nodes: colliders keep the nodes out; barrier: no part of the surface ever touches a collider "
            "or the surface itself, which every step of implicit Euler makes sure of")
        .number("contact_distance", &D::contact_distance, "m", at_least(0),
                "kept from every obstacle, default 0; of a barrier where it begins to push, default a "
                "thousandth of the body's size")
        .number("restitution", &D::restitution, "1", between(0, 1),
                "on any collider, in place of the collider's own")
        .number("friction", &D::friction, "1", at_least(0),
                "Coulomb's coefficient on colliders; absent: each collider's own");
    add_collider_rows(table, &D::colliders);
    add_integrator_rows(table);
    return table.check(check_def).build();
  }();
  return t;
}

}  // namespace truestep::fem
