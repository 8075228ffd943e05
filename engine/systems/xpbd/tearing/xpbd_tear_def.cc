// Checks of cloth that tears in a scene; see tear_surface.h.
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& tear_table() {
  static const DefTable t =
      TableOf<TearDef>("limits beyond which cloth tears between its triangles")
          .number("strain", &TearDef::strain, "1", above(0),
                  "largest length / rest length - 1 that a link between neighbours withstands at the end of "
                  "a step")
          .number("force", &TearDef::force, "N", above(0),
                  "largest tension that a link between neighbours withstands: stiffness times elongation")
          .integer(
              "most_splits", &TearDef::most_splits, between(1, 10'000'000),
              "most points that may be split off; after that nothing tears; default: the number of points")
          .check([](const TearDef& d, const DefTable::Report& report) {
            if (!d.strain && !d.force) report("", "give strain, force or both");
          })
          .build();
  return t;
}

void check_tear(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.tear) return;
  if (!d.cloth_grid && !d.mesh) return report("/tear", "only cloth_grid and mesh can tear");
  if (d.scheme == Scheme::pbd && d.tear->force)
    report("/tear/force", "links have no force with scheme pbd: give strain");
}

}  // namespace truestep::xpbd
