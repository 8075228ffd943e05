// Ropes and hair: chains of structural springs, with skip-one springs against bending.
#include "engine/systems/mass_spring/network.h"

namespace truestep::mass_spring {

namespace {

void add_chain(size_t first, size_t points, const MassSpringDef& def, double link, Network& out) {
  const double rest = def.rest_scale * link, skip_rest = def.rest_scale * 2 * link;
  for (size_t i = first; i + 1 < first + points; ++i) {
    out.springs.push_back(
        {static_cast<uint32_t>(i), static_cast<uint32_t>(i + 1), SpringFamily::structural, rest, 1});
  }
  for (size_t i = first; def.bending_rigidity > 0 && i + 2 < first + points; ++i) {
    const auto k = static_cast<uint32_t>(i);
    out.bends.push_back({{k, k + 1, k + 2}, def.bending_rigidity / link});
  }
  if (!(def.bending_stiffness > 0)) return;
  for (size_t i = first; i + 2 < first + points; ++i) {
    out.springs.push_back(
        {static_cast<uint32_t>(i), static_cast<uint32_t>(i + 2), SpringFamily::bending, skip_rest, 1});
  }
}

}  // namespace

void build_rope(const RopeShape& shape, const MassSpringDef& def, const Vec3& down, Network& out) {
  const auto links = static_cast<size_t>(shape.links);
  const double link = rope_link(shape);
  out.x = rope_points(shape, down);
  out.share.assign(links + 1, link);
  out.share.front() = out.share.back() = 0.5 * link;
  add_chain(0, links + 1, def, link, out);
}

void build_hair(const HairShape& shape, const MassSpringDef& def, Network& out) {
  const auto points = static_cast<size_t>(shape.links) + 1;
  const double link = shape.length / shape.links;
  out.x = hair_points(shape);
  for (size_t first = 0; first < out.x.size(); first += points) {
    for (size_t i = 0; i < points; ++i) out.share.push_back(i + 1 == points ? 0.5 * link : link);
    // Two held points fix the direction at the root.
    out.pins.push_back(static_cast<uint32_t>(first));
    out.pins.push_back(static_cast<uint32_t>(first + 1));
    add_chain(first, points, def, link, out);
  }
}

}  // namespace truestep::mass_spring
