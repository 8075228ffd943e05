// Checks of membranes, attachments and tethers in a scene.
#include <string>

#include "engine/geometry/make/surface.h"
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
        d.tear ? ", so that what a tear parts there is not known: split the mesh there or leave tear out"
               : ", so that what bends there is not known: split the mesh there or leave "
                 "flexural_rigidity out");
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
