#include "engine/systems/mass_spring/network.h"

#include <algorithm>

namespace truestep::mass_spring {

namespace {

void add_pin(std::vector<uint32_t>& pins, size_t i) {
  pins.push_back(static_cast<uint32_t>(i));
}

void add_named_pins(const MassSpringDef& def, const std::string& name, Network& out) {
  const size_t n = out.x.size();
  if (def.cloth_grid) {
    for (const uint32_t i : named_grid_points(*def.cloth_grid, name)) add_pin(out.pins, i);
  }
  if (name == "first" || name == "ends") add_pin(out.pins, 0);
  if (name == "last" || name == "ends") add_pin(out.pins, n - 1);
}

}  // namespace

LineKind line_kind(SpringFamily family) {
  return family == SpringFamily::own ? LineKind::other : static_cast<LineKind>(family);
}

Network build_network(const MassSpringDef& def, const Vec3& down) {
  Network out;
  if (def.rope) build_rope(*def.rope, def, down, out);
  if (def.hair) build_hair(*def.hair, def, out);
  if (def.cloth_grid) build_cloth_grid(*def.cloth_grid, def, out);
  if (def.mesh) build_mesh(*def.mesh, def, out);
  if (def.free) build_free(*def.free, out);

  for (SpringLink& s : out.springs) {
    if (s.rest < 0) s.rest = def.rest_scale * norm(out.x[s.b] - out.x[s.a]);
  }
  for (const int64_t i : def.pins) add_pin(out.pins, static_cast<size_t>(i));
  for (const std::string& name : def.pinned) add_named_pins(def, name, out);
  std::sort(out.pins.begin(), out.pins.end());
  out.pins.erase(std::unique(out.pins.begin(), out.pins.end()), out.pins.end());

  if (out.v.empty()) out.v.assign(out.x.size(), def.velocity);
  for (const uint32_t i : out.pins) out.v[i] = {};
  return out;
}

std::vector<double> point_masses(const MassSpringDef& def, const Network& network) {
  if (def.free && !def.free->masses.empty()) return def.free->masses;
  if (!def.density) return std::vector<double>(network.x.size(), def.mass);
  std::vector<double> m;
  m.reserve(network.share.size());
  // A vertex of no triangle has no share: it gets the mass of a point instead.
  for (const double s : network.share) m.push_back(s > 0 ? s * *def.density : def.mass);
  return m;
}

}  // namespace truestep::mass_spring
