// What a scene says about membranes, attachments and tethers.
#include <algorithm>
#include <array>
#include <vector>

#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& attachment_table() {
  static const DefTable t =
      TableOf<AttachmentDef>("a point held to a place by a spring")
          .integer("point", &AttachmentDef::point, at_least(0), "index of the point")
          .required()
          .vector("target", &AttachmentDef::target, "m", any(), "absent: where the point is at the start")
          .number("stiffness", &AttachmentDef::stiffness, "N/m", above(0),
                  "absent: that of the stiffest link at the point")
          .build();
  return t;
}

namespace {

/// Edges without length, which have no direction, and edges of three triangles, which have no angle. Indices
/// that are out of range have an error of their own.
void check_mesh(const XpbdDef& d, const DefTable::Report& report) {
  const auto& corners = d.mesh->triangles;
  const auto n = static_cast<int64_t>(d.mesh->vertices.size());
  std::vector<std::array<int64_t, 3>> edges;  // lower, higher, corner
  for (size_t k = 0; k + 2 < corners.size(); k += 3) {
    for (size_t i = 0; i < 3; ++i) {
      const int64_t a = corners[k + i], b = corners[k + (i + 1) % 3];
      if (a < 0 || b < 0 || a >= n || b >= n) return;
      if (a == b) continue;
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int64_t>(k + i)});
    }
  }
  std::sort(edges.begin(), edges.end());
  const auto fault = [&](const std::array<int64_t, 3>& edge, const std::string& what) {
    report("/mesh/triangles/" + std::to_string(edge[2]),
           "the edge of vertices " + std::to_string(edge[0]) + " and " + std::to_string(edge[1]) + what);
  };
  for (const auto& e : edges) {
    const Vec3 along =
        d.mesh->vertices[static_cast<size_t>(e[1])] - d.mesh->vertices[static_cast<size_t>(e[0])];
    if (!(norm2(along) > 0) && !d.matching) return fault(e, " has no length: merge them");
  }
  if (!(d.flexural_rigidity > 0)) return;
  for (size_t i = 2; i < edges.size(); ++i) {
    if (edges[i][0] != edges[i - 2][0] || edges[i][1] != edges[i - 2][1]) continue;
    return fault(edges[i],
                 " has more than two triangles, so that what bends there is not known: "
                 "split the mesh there or leave flexural_rigidity out");
  }
}

}  // namespace

void check_sheet(const XpbdDef& d, const DefTable::Report& report) {
  if (d.mesh) check_mesh(d, report);
  if (d.tether_slack && d.tear) report("/tether_slack", "what tears has no way along links that stays");
  if (d.tether_slack && d.matching) report("/tether_slack", "what is matched has no links");
  if (d.membrane == Membrane::links) return;
  if (!d.cloth_grid && !d.mesh) return report("/membrane", "only cloth_grid and mesh are made of triangles");
  if (d.tear) report("/tear", "membranes have no links that could tear: take links");
  if (d.matching) report("/matching", "what is matched has no membrane");
  if (d.internal_damping > 0)
    report("/internal_damping", "it is along links, and here are none: give damping");
  if (d.precision == Precision::f32) report("/precision", "a membrane needs f64");
  if (d.scheme == Scheme::pbd) {
    if (d.membrane == Membrane::neo_hookean)
      report("/membrane", "pbd knows no energies: st_venant_kirchhoff or links");
    if (d.youngs_modulus) report("/youngs_modulus", "pbd knows no moduli: leave it out or use xpbd");
    return;
  }
  if (!d.youngs_modulus) report("/youngs_modulus", "a membrane needs one");
  if (!(d.thickness > 0)) report("/thickness", "a membrane needs one above 0");
}

}  // namespace truestep::xpbd
