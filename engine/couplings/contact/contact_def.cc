#include "engine/couplings/contact/contact_def.h"

namespace truestep::contact {

const DefTable& contact_table() {
  using D = ContactDef;
  static const DefTable t =
      TableOf<D>(
          "points of one system against the solids of the other "
          "(triangles of a cloth, springs as capsules, "
          "balls) or its rigid bodies, which recoil; with itself, a system of particles "
          "collides ball against ball")
          .number("restitution", &D::restitution, "1", between(0, 1),
                  "share of the normal speed kept in a bounce")
          .number("friction", &D::friction, "1", at_least(0), "Coulomb's coefficient")
          .number("rest_speed", &D::rest_speed, "m/s", at_least(0), "slower approaches do not bounce")
          .build();
  return t;
}

Cost contact_cost(const void*, const Cost& a, const Cost& b) {
  const double n = a.elements + b.elements;
  // The substep's start, boxes and cells of the solids; a tenth of the points in contact.
  return {.state_bytes = 128, .workspace_bytes = 30 * n, .elements = 0, .seconds_per_step = 1.2e-7 * n};
}

}  // namespace truestep::contact
