// Soft things and rigid bodies in space joined by one coupling, at defaults: closed and undamped, with masses
// from a thousandth to ten thousand times each other and stiffness over several powers of ten. Nothing may
// gain energy in silence: a scene holds, ends with an event, or is refused.
#include <algorithm>
#include <array>
#include <vector>

#include "tests/stability/campaign/parts.h"
#include "tests/stability/campaign/soft_things.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

enum class Tie : uint8_t { contact, spring, rigid };

json::object body(Dice& d, double mass, double& reach) {
  const double size = d.between(0.05, 0.2);
  json::object b{{"type", d.of({"box", "sphere", "capsule", "cylinder"})},
                 {"axis", vec(d.direction())},
                 {"angle", d.between(0, 3)},
                 {"mass", mass}};
  reach = size;
  if (b["type"] == "box") {
    b["half_extents"] = vec(size, size * d.between(0.3, 1), size * d.between(0.3, 1)), reach = 1.75 * size;
  } else {
    b["radius"] = size;
    if (b["type"] != "sphere") b["half_length"] = size, reach = 2 * size;
  }
  return b;
}

/// Bodies fall or fly onto it.
json::object hit_by(Dice& d, SoftThing& s, double heavy, json::array& bodies) {
  double y = s.top + 0.02;
  for (int n = d.whole(1, 3); n-- > 0;) {
    double reach = 0;
    json::object b = body(d, heavy * s.mass * d.spread(0.5, 2), reach);
    y += reach + d.between(0.01, 0.3);
    b["position"] = vec(d.between(-0.2, 0.2), y, d.between(-0.2, 0.2)), y += reach;
    b["velocity"] = vec(Vec3{0, -d.between(0, 3), 0} + d.in_cube(0.5));
    bodies.push_back(std::move(b));
  }
  return {{"type", "contact"}, {"restitution", d.of({0.0, 0.3, 0.8})}, {"friction", d.between(0, 1)}};
}

/// One body hangs on one to three of its points.
json::object tied_to(Dice& d, SoftThing& s, double heavy, bool spring, json::array& bodies) {
  double reach = 0;
  json::object b = body(d, heavy * s.mass, reach);
  const Vec3 at = s.end + (d.chance(0.5) ? Vec3{0, -1, 0} : d.direction()) * d.between(0.05, 0.5);
  b["position"] = vec(at);
  if (d.chance(0.5)) b["velocity"] = vec(d.in_cube(1)), b["angular_velocity"] = vec(d.in_cube(3));
  bodies.push_back(std::move(b));
  const int pairs = d.of({1, 1, 2, 3});
  json::array points, rows, places;
  for (int k = 0; k < pairs; ++k) {
    points.push_back(s.ends[static_cast<size_t>(k)]), rows.push_back(0);
    places.push_back(vec(at + d.in_cube(0.5 * reach)));
  }
  json::object tie{{"type", "attachment"}, {"a_points", points}, {"b_points", rows}};
  if (pairs > 1 || d.chance(0.7)) tie["places"] = places;
  tie["link"] = spring ? "spring" : "rigid";
  if (spring) tie["stiffness"] = d.spread(10, 1e7);
  return tie;
}

template <Soft kind, Tie by>
void coupled(Dice& d, Trial& t) {
  SoftThing s = soft(d, kind);
  const double heavy = d.spread(1e-3, 1e4), dt = d.of({1.0 / 60, 1.0 / 60, 1.0 / 120, 1.0 / 240});
  json::array bodies;
  json::object join =
      by == Tie::contact ? hit_by(d, s, heavy, bodies) : tied_to(d, s, heavy, by == Tie::spring, bodies);
  join["id"] = "c", join["a"] = "a", join["b"] = "b";
  if (d.chance(0.3)) {
    bodies.push_back(json::object{{"type", "plane"}, {"motion", "fixed"}, {"position", vec(0, -2)}});
  }
  set_scene(t, dt, d.between(0.5, 1.5), kDown,
            {std::move(s.system), json::object{{"type", "rigid3d"}, {"bodies", std::move(bodies)}}});
  t.scene["couplings"] = json::array{std::move(join)};
  t.rules.gain = 0.01, t.rules.event = Rules::Event::allowed;
}

}  // namespace

std::span<const Family> coupled_families() {
  using enum Soft;
  using enum Tie;
  static constexpr std::array kAll{
      Family{"xpbd_cloth_contact", coupled<xpbd_cloth, contact>},
      Family{"xpbd_cloth_spring", coupled<xpbd_cloth, spring>},
      Family{"xpbd_cloth_rigid", coupled<xpbd_cloth, rigid>},
      Family{"xpbd_rope_contact", coupled<xpbd_rope, contact>},
      Family{"xpbd_rope_spring", coupled<xpbd_rope, spring>},
      Family{"xpbd_rope_rigid", coupled<xpbd_rope, rigid>},
      Family{"xpbd_block_contact", coupled<xpbd_block, contact>},
      Family{"xpbd_block_spring", coupled<xpbd_block, spring>},
      Family{"xpbd_block_rigid", coupled<xpbd_block, rigid>},
      Family{"fem_block_contact", coupled<fem_block, contact>},
      Family{"fem_block_spring", coupled<fem_block, spring>},
      Family{"fem_block_rigid", coupled<fem_block, rigid>},
      Family{"fem_sheet_contact", coupled<fem_sheet, contact>},
      Family{"fem_sheet_spring", coupled<fem_sheet, spring>},
      Family{"fem_sheet_rigid", coupled<fem_sheet, rigid>},
      Family{"spring_cloth_contact", coupled<spring_cloth, contact>, true},
      Family{"spring_cloth_spring", coupled<spring_cloth, spring>},
      Family{"spring_cloth_rigid", coupled<spring_cloth, rigid>},
      Family{"spring_rope_contact", coupled<spring_rope, contact>},
      Family{"spring_rope_spring", coupled<spring_rope, spring>},
      Family{"spring_rope_rigid", coupled<spring_rope, rigid>},
      Family{"spring_net_contact", coupled<spring_net, contact>},
      Family{"spring_net_spring", coupled<spring_net, spring>},
      Family{"spring_net_rigid", coupled<spring_net, rigid>},
  };
  return kAll;
}

}  // namespace truestep::campaign
