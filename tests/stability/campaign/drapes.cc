// Soft things that fall on colliders at rest: balls, boxes, capsules and floors that stand between points
// that stiff links, constraints or elements hold together. Colliders and gravity give no energy, so that
// nothing may gain any.
#include <array>

#include "tests/stability/campaign/parts.h"
#include "tests/stability/campaign/soft_things.h"

namespace truestep::campaign {
namespace {

constexpr double kGravity = 9.81;

/// As thick as some link is long, or of any size.
json::object collider(Dice& d, double top, double link) {
  const double size = d.chance(0.6) ? 0.5 * link * d.between(0.85, 1.05) : d.between(0.05, 0.3);
  const Vec3 beside{d.between(-0.3, 0.3), 0, d.between(-0.3, 0.3)};
  json::object c{{"type", d.of({"sphere", "box", "capsule"})}};
  if (c["type"] == "sphere") {
    c["center"] = vec(beside + Vec3{0, top - size, 0}), c["radius"] = size;
  } else if (c["type"] == "box") {
    const Vec3 half{size, size * d.between(0.1, 1), size * d.between(0.3, 1)};
    c["center"] = vec(beside + Vec3{0, top - norm(half), 0}), c["half_extents"] = vec(half);
    if (d.chance(0.7)) c["axis"] = vec(d.direction()), c["angle"] = d.between(0, 3);
  } else {
    const Vec3 along = d.direction() * d.between(0.05, 0.6), middle = beside + Vec3{0, top - 0.6 - size, 0};
    c["from"] = vec(middle - along), c["to"] = vec(middle + along), c["radius"] = size;
  }
  return c;
}

template <Soft kind>
void drape(Dice& d, Trial& t) {
  // Blocks of constraints that are much stiffer than usual are refused: they need thousands of substeps.
  constexpr double kStiffer = kind == Soft::xpbd_block ? 1 : 1e4;
  SoftThing s = soft(d, kind, kStiffer);
  const double dt = d.of({1.0 / 60, 1.0 / 60, 1.0 / 120, 1.0 / 240});
  json::array colliders;
  for (int n = d.whole(1, 5); n-- > 0;)
    colliders.push_back(collider(d, s.low - 0.02 - d.of({0.0, 0.3, 0.8}) * d.unit(), s.link));
  if (d.chance(0.4)) {
    Vec3 normal{0, 1, 0};
    if (d.chance(0.5)) normal = Vec3{0, 1, 0} + d.in_cube(0.3);
    colliders.push_back(json::object{
        {"type", "plane"}, {"point", vec(0, s.low - 0.6 - d.between(0, 0.6))}, {"normal", vec(normal)}});
  }
  for (json::value& c : colliders) {
    if (d.chance(0.7)) c.as_object()["friction"] = d.between(0, 1);
  }
  if (s.system.contains("cloth_grid") && d.chance(0.5)) s.system["pinned"] = json::array{"edge_u0"};
  Vec3 velocity;
  if (d.chance(0.4)) velocity = Vec3{0, -d.between(0, 5), 0} + d.in_cube(2);
  s.system["velocity"] = vec(velocity);
  s.system["restitution"] = d.of({0.0, 0.0, 0.5, 1.0});
  s.system["colliders"] = std::move(colliders);
  const double seconds = d.between(0.5, 1.5);
  const bool by_constraints = s.system["type"] == "xpbd";
  set_scene(t, dt, seconds, {0, -kGravity, 0}, {std::move(s.system)});
  t.rules.event = Rules::Event::allowed;
  if (!by_constraints) {
    t.rules.gain = 0.01;
    return;
  }
  // Links that a substep cannot satisfy are stretched by what is left, which their stiffness makes a large
  // energy that no motion has given and none gets: only what moves is judged.
  const double fastest = norm(velocity) + kGravity * seconds;
  t.rules.gain.reset();
  expect_range(t, "max(energy.kinetic)", 0, 1.01 * 0.5 * s.mass * fastest * fastest,
               "what falls all the time is no faster");
}

}  // namespace

std::span<const Family> drape_families() {
  using enum Soft;
  static constexpr std::array kAll{
      Family{"drape_spring_cloth", drape<spring_cloth>}, Family{"drape_spring_rope", drape<spring_rope>},
      Family{"drape_spring_net", drape<spring_net>},     Family{"drape_xpbd_cloth", drape<xpbd_cloth>},
      Family{"drape_xpbd_rope", drape<xpbd_rope>},       Family{"drape_xpbd_block", drape<xpbd_block>},
      Family{"drape_fem_block", drape<fem_block>},       Family{"drape_fem_sheet", drape<fem_sheet>},
  };
  return kAll;
}

}  // namespace truestep::campaign
