#include "engine/couplings/attachment/attachment_def.h"

namespace truestep::attachment {

const DefTable& attachment_table() {
  using D = AttachmentDef;
  static const DefTable t =
      TableOf<D>(
          "joins points of two systems, or points and rigid bodies, pair by pair, with "
          "springs or rigid links")
          .choice("link", &D::link, {"spring", "rigid"},
                  "spring: force along the pair; rigid: constant distance")
          .integers("a_points", &D::a_points, between(-1e9, 1e9), {1, 100'000},
                    "points (or bodies) of a, one per pair; -1 is the last one at t = 0")
          .integers("b_points", &D::b_points, between(-1e9, 1e9), {1, 100'000},
                    "points (or bodies) of b, one per pair; -1 is the last one at t = 0")
          .number("stiffness", &D::stiffness, "N/m", at_least(0), "of a spring")
          .number("damping", &D::damping, "N s/m", at_least(0), "of a spring, along the pair")
          .number("rest_length", &D::rest_length, "m", at_least(0),
                  "distance without force; absent: that at t = 0; 0: the points coincide")
          .vectors("places", &D::places, "m", any(), {0, 100'000},
                   "points of the bodies, in the world at t = 0, one per pair; absent: their centres of mass")
          .check([](const D& d, const DefTable::Report& report) {
            if (d.a_points.size() != d.b_points.size()) {
              report("/b_points", "needs as many points of b as of a: " + std::to_string(d.a_points.size()));
            }
            if (!d.places.empty() && d.places.size() != d.a_points.size()) {
              report("/places", "needs one place per pair, or none: " + std::to_string(d.a_points.size()));
            }
          })
          .build();
  return t;
}

Cost attachment_cost(const void* def, const Cost&, const Cost&) {
  const auto& d = *static_cast<const AttachmentDef*>(def);
  const auto pairs = static_cast<double>(d.a_points.size());
  return {.state_bytes = 256,
          .workspace_bytes = 32 * pairs,
          .elements = pairs,
          // Rigid links that share points take several sweeps.
          .seconds_per_step = pairs * (d.link == AttachmentDef::Link::rigid ? 1.5e-6 : 1e-7)};
}

}  // namespace truestep::attachment
