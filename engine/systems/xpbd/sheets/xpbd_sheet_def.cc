// Checks of membranes, attachments and tethers in a scene.
#include <string>

#include "engine/geometry/make/surface.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& attachment_table() {
  static const DefTable t =
      TableOf<AttachmentDef>("a spring from a point to a fixed position")
          .integer("point", &AttachmentDef::point, at_least(0), "index of the point")
          .required()
          .vector("target", &AttachmentDef::target, "m", any(), "absent: the point's initial position")
          .number("stiffness", &AttachmentDef::stiffness, "N/m", above(0),
                  "absent: that of the stiffest link at the point")
          .build();
  return t;
}

namespace {

/// Edges of zero length, which have no direction, triangles of zero area, which have no mass, and edges of
/// three triangles, which have no angle.
void check_mesh(const XpbdDef& d, const DefTable::Report& report) {
  const auto fault = [&](const ClothFault& f, const char* more) {
    report("/mesh/triangles/" + std::to_string(f.corner), f.what + more);
  };
  const auto flat = d.matching ? std::nullopt : flat_triangle(*d.mesh);
  if (flat) return fault(*flat, "");
  if (!(d.flexural_rigidity > 0) && !d.tear) return;
  const auto crowded = crowded_edge(*d.mesh);
  if (!crowded) return;
  fault(*crowded,
        d.tear ? ", where the two sides of a tear are undefined: split the mesh there or leave tear out"
               : ", where bending is undefined: split the mesh there or leave flexural_rigidity out");
}

}  // namespace

void check_sheet(const XpbdDef& d, const DefTable::Report& report) {
  if (d.mesh) check_mesh(d, report);
  if (d.tether_slack && d.tear)
    report("/tether_slack", "tethers run along links, which tear may cut: leave one of them out");
  if (d.tether_slack && d.matching) report("/tether_slack", "a body with matching has no links");
  if (d.membrane == Membrane::links) return;
  if (!d.cloth_grid && !d.mesh) return report("/membrane", "only cloth_grid and mesh are made of triangles");
  if (d.tear) report("/tear", "membranes have no links that could tear: use membrane links");
  if (d.matching) report("/matching", "a body with matching has no membrane");
  if (d.internal_damping > 0)
    report("/internal_damping", "it acts along links, and there are none: give damping");
  if (d.precision == Precision::f32) report("/precision", "a membrane needs f64");
  if (d.scheme == Scheme::pbd) {
    if (d.membrane == Membrane::neo_hookean)
      report("/membrane", "not available with scheme pbd: use st_venant_kirchhoff or links");
    if (d.youngs_modulus)
      report("/youngs_modulus", "scheme pbd has no elastic moduli: leave it out or use xpbd");
    return;
  }
  if (!d.youngs_modulus) report("/youngs_modulus", "a membrane needs a Young's modulus");
  if (!(d.thickness > 0)) report("/thickness", "a membrane needs a thickness above 0");
}

}  // namespace truestep::xpbd
