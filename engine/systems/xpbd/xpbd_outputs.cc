// What the system type "xpbd" gives out, in words, and what it will cost.
#include <algorithm>
#include <cmath>

#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const Outputs& xpbd_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a point: along a rope from its first end, strand by strand of hair, j nx + i of a cloth grid, in "
          "the "
          "order given of a mesh, x running fastest in a block",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"strain", "1", 1, "largest |length / rest length - 1| of its links"},
                 {"links.strain", "1", 1, "of part links, a row per link: length / rest length - 1"}},
      .observables = {{"energy.kinetic", "J", "of motion"},
                      {"energy.potential", "J", "of gravity, hands and all constraints; scheme xpbd alone"},
                      {"energy.total", "J", "their sum; scheme xpbd alone"},
                      {"momentum.x", "kg m/s", "of all that moves freely"},
                      {"momentum.y", "kg m/s", ""},
                      {"momentum.z", "kg m/s", ""},
                      {"angular_momentum.x", "kg m^2/s", "about the origin, of all that moves freely"},
                      {"angular_momentum.y", "kg m^2/s", ""},
                      {"angular_momentum.z", "kg m^2/s", ""},
                      {"strain.max", "1", "largest |length / rest length - 1| of links between neighbours"},
                      {"strain.rms", "1", "root of the mean square of the same"},
                      {"pins", "1", "points that are held"}}};
  return kOutputs;
}

Cost xpbd_cost(const void* def) {
  const auto& d = *static_cast<const XpbdDef*>(def);
  const XpbdCounts n = xpbd_counts(d);
  // As the default of substeps where it is most: one that is not named follows from sizes and speeds.
  const double substeps = d.substeps ? *d.substeps : d.scheme == Scheme::pbd ? 1 : 20;
  const double iterations = d.iterations ? *d.iterations : d.scheme == Scheme::pbd ? 20 : 1;
  const bool single = d.precision == Precision::f32;
  const double constraints = n.links + n.bends + n.volumes;
  return {.state_bytes = 56 * n.points,
          .workspace_bytes = (single ? 1 : 2) * (64 * n.points + 24 * n.links + 48 * (n.bends + n.volumes)) +
                             (d.colliders.empty() && !d.self_collision ? 0 : 104 * n.points) +
                             (d.self_collision ? 2500 * n.points : 0) + (d.wind ? 48 * n.points : 0),
          .elements = n.points + constraints,
          .seconds_per_step =
              substeps * (3e-9 * n.points + (d.colliders.empty() ? 0 : 2e-8 * n.points) +
                          (d.self_collision ? 1e-6 * n.points : 0) + (d.wind ? 6e-8 * n.points : 0) +
                          iterations * (single ? 4e-9 : 8e-9) * constraints)};
}

}  // namespace truestep::xpbd
