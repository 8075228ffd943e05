// Finds faults in a scene's body of elements, each with its pointer: shapes, elements and materials that do
// not fit together, invalid cells, unknown names.
#include <algorithm>
#include <cmath>

#include "engine/geometry/make/weld.h"
#include "engine/systems/fem/bending.h"
#include "engine/systems/fem/fem_tables.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

namespace {

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
    report("/element", "a shell needs tri6; a membrane takes other elements too");
  if (d.plane == Plane::membrane && !d.clamped.empty())
    report("/clamped", "a membrane has no edge direction to clamp: use plane shell, or pinned");
  if (d.material == Law::linear)
    report("/material", "a sheet rotates in space: use corotated, which is the same for small strains");
  if (d.volume == Volume::mean)
    report("/volume", "a sheet thins when stretched and does not lock: leave it pointwise");
  if (d.contact == Meeting::barrier) report("/contact", "sheets cannot use a barrier");
}

void check_element(const FemDef& d, const Report& report) {
  const Element& kind = element_of(kind_of(cell_of(d)));
  if (d.block && kind.dimension == 2) report("/element", "a block is made of tet4, tet10, hex8 or hex27");
  if (d.fill && !(kind.simplex && kind.dimension == 3))
    report("/element", "a region is filled with tet4 or tet10");
  if (d.quad && kind.dimension == 3) report("/element", "a quad is made of tri3, tri6, quad4 or quad9");
  if (d.mesh && d.mesh->form == Form::as_element && d.element == Cell::automatic)
    report("/element", "give the element of the mesh: " + listed(cell_names()));
  if (d.mesh && d.mesh->form != Form::as_element && form_of(kind) != d.mesh->form)
    report("/element", std::string("the mesh is made of ") + kForms[static_cast<size_t>(d.mesh->form)]);
  if (kind.dimension == 3 && d.plane != Plane::strain)
    report("/plane", "only bodies of tri3, tri6, quad4 or quad9 are plane or sheets");
  if (is_sheet(d)) check_sheet(d, report);
  if (d.incompatible_modes == Incompatible::wilson) {
    const bool first = !kind.simplex && kind.size() == kind.corners;
    if (!first || is_sheet(d))
      report("/incompatible_modes", "only for hex8 and plane quad4: other elements bend without them");
    if (d.volume == Volume::mean)
      report("/incompatible_modes", "not available with volume mean: leave volume pointwise");
  }
  if (d.volume != Volume::mean) return;
  if (kind.points.size() == 1) {
    report("/volume", "no effect on an element with one quadrature point: use tri6, quad4, tet10, hex8 ...");
  }
  if (kind.dimension == 2 && d.plane == Plane::stress) {
    report("/volume", "in plane stress the thickness adapts and nothing locks: leave it pointwise");
  }
}

void check_material(const FemDef& d, const Report& report) {
  if (d.second_share > 0 && d.material != Law::mooney_rivlin) {
    return report("/second_share", "only for material mooney_rivlin");
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
                                     " corners: the number of indices is not a multiple of that");
  }
  if (in_plane(d)) {
    for (size_t i = 0; i < d.mesh->vertices.size(); ++i) {
      if (d.mesh->vertices[i].z == 0) continue;
      return report("/mesh/vertices/" + std::to_string(i), "a plane body must lie in z = 0");
    }
  }
  const Mesh mesh = build_mesh(d);
  const size_t bad = first_bad_cell(mesh);
  if (bad != static_cast<size_t>(-1)) {
    report("/mesh/cells/" + std::to_string(bad * kind.corners),
           "element " + std::to_string(bad) +
               " is flat or turned inside out: number its corners in VTK's order");
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
                      " coincide: a shell may be bent at an edge, not folded flat");
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
      report("/holds/" + std::to_string(k) + "/z", "a plane body must stay in z = 0");
  }
}

bool check_fill(const FillShape& f, const Report& report) {
  const int regions = f.ball.has_value() + f.cylinder.has_value() + f.surface.has_value();
  if (regions != 1) {
    report("/fill", "give exactly one of ball, cylinder and surface, not " + std::to_string(regions));
    return false;
  }
  if (f.surface) {
    auto triangles = mesh_triangles(*f.surface);
    if (const auto fault = surface_fault(triangles)) {
      // Corners that are repeated at one place are one: only then is something missing.
      const std::vector<uint32_t> first = first_at_place(f.surface->vertices);
      for (auto& t : triangles) t = {first[t[0]], first[t[1]], first[t[2]]};
      if (!surface_fault(triangles)) return true;
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
    if (c.position.z != 0) report(at + "/position", "a plane body must lie in z = 0");
    if (c.axis.x != 0 || c.axis.y != 0) report(at + "/axis", "a plane body turns about z");
    if (c.velocity.z != 0) report(at + "/velocity", "a plane body must stay in z = 0");
  }
}

void check_barrier(const FemDef& d, const Report& report) {
  if (d.contact != Meeting::barrier) return;
  if (in_plane(d)) report("/contact", "plane bodies cannot use a barrier");
  if (d.motion == Motion::quasi_static) report("/contact", "a barrier needs motion dynamic");
  if (!d.integrator.empty())
    report("/integrator", "contact barrier always uses implicit Euler: leave it out");
  if (d.restitution > 0)
    report("/restitution", "with a barrier the rebound follows from the elastic body: leave it out");
  if (d.contact_distance && !(*d.contact_distance > 0))
    report("/contact_distance", "a barrier needs a distance above 0");
  for (size_t k = 0; k < d.loads.size(); ++k) {
    if (d.loads[k].pressure)
      report("/loads/" + std::to_string(k) + "/pressure",
             "a barrier needs loads with a potential, which a pressure does not have: use a force or a "
             "traction");
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
             "with contact barrier a hold must prescribe x, y and z together, or fix single ones at 0");
    }
  }
}

}  // namespace

void check_fem(const FemDef& d, const Report& report) {
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
    return report("/fill/spacing", "too large for this region: no element of the lattice is left inside");
  check_names(d, report);
  check_copies(d, report);
  check_barrier(d, report);
  if (in_plane(d) && !d.colliders.empty()) report("/colliders", "plane bodies cannot meet colliders");
  if (in_plane(d) && d.velocity.z != 0) report("/velocity", "a plane body must stay in z = 0");
  if (d.motion == Motion::quasi_static) {
    if (!d.integrator.empty()) report("/integrator", "quasi-static motion uses no integrator: leave it out");
    if (d.pins.empty() && d.pinned.empty() && d.clamped.empty() && d.holds.empty()) {
      report("/motion", "nothing holds the body: quasi-static motion needs pins, pinned or holds");
    }
    if (!d.colliders.empty()) report("/colliders", "quasi-static bodies cannot meet colliders");
    if (d.damping > 0) report("/damping", "a quasi-static body has no velocity");
  }
}

}  // namespace truestep::fem
