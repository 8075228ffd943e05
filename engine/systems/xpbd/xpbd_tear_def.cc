// Checks of cloth that tears in a scene; see tear_surface.h.
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& tear_table() {
  static const DefTable t =
      TableOf<TearDef>("limits beyond which cloth tears between its triangles")
          .number("strain", &TearDef::strain, "1", above(0),
                  "of a link between neighbours: length / rest length - 1 that it bears at the end of a step")
          .number("force", &TearDef::force, "N", above(0),
                  "that a link between neighbours bears: its stiffness times what it is longer than at rest")
          .integer("most_splits", &TearDef::most_splits, between(1, 10'000'000),
                   "points that may be split off, after which nothing tears any more; default: as many as "
                   "there are points")
          .check([](const TearDef& d, const DefTable::Report& report) {
            if (!d.strain && !d.force) report("", "give strain, force or both");
          })
          .build();
  return t;
}

void check_tear(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.tear) return;
  if (!d.cloth_grid && !d.mesh) return report("/tear", "only cloth_grid and mesh tear");
  if (d.scheme == Scheme::pbd && d.tear->force) report("/tear/force", "links of pbd have none: give strain");
}

}  // namespace truestep::xpbd
