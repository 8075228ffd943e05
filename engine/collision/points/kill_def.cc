#include "engine/collision/points/kill_def.h"

namespace truestep {

const DefTable& kill_plane_table() {
  using D = KillPlaneDef;
  static const DefTable t =
      TableOf<D>("removes every particle below a plane")
          .vector("point", &D::point, "m", any(), "a point of the plane")
          .vector("normal", &D::normal, "1", any(), "pointing to the side where particles remain")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(norm(d.normal) > 0)) report("/normal", "the normal must not be zero");
          })
          .build();
  return t;
}

const DefTable& kill_box_table() {
  using D = KillBoxDef;
  static const DefTable t = TableOf<D>("removes every particle inside or outside a box")
                                .vector("center", &D::center, "m", any(), "centre")
                                .vector("half_extents", &D::half_extents, "m", above(0), "half of each edge")
                                .choice("where", &D::where, {"inside", "outside"},
                                        "whether particles are removed inside or outside")
                                .build();
  return t;
}

}  // namespace truestep
