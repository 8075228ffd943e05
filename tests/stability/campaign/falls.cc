// Something falls on something that should hold it: soft things, points and bodies on cloth, blocks, floors
// and into tanks, with couplings that hold and some that cannot. Nothing may fall through, or past the scene,
// in silence: what is under it holds it, or a warning says that nothing does.
#include <algorithm>
#include <string>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};
/// m below what should hold it at which a thing has fallen through: half of the smallest.
constexpr double kThrough = 0.06;
/// s, in which a thing that nothing holds falls by ten times the largest scene.
constexpr double kLong = 3;

json::object grid(double side, double y, int n) {
  return {{"origin", vec(-0.5 * side, y, -0.5 * side)},
          {"edge_u", vec(side, 0, 0)},
          {"edge_v", vec(0, 0, side)},
          {"nx", n},
          {"ny", n}};
}
json::object box_at(const Vec3& low, const Vec3& size, int n) {
  return {{"origin", vec(low)},
          {"size", vec(size)},
          {"cells_x", n},
          {"cells_y", std::max(1, n / 2)},
          {"cells_z", n}};
}

struct Thing {
  json::object system;
  double mass = 0;     ///< kg, of all of it
  bool points = true;  ///< otherwise bodies
};

/// Lies within 0.3 m of the axis, its lowest point at y.
Thing faller(Dice& d, double y) {
  const std::string kind =
      d.of({"fem", "fem", "xpbd", "xpbd", "cloth", "net", "rope", "grains", "rigid3d", "rigid3d"});
  const double side = d.between(0.15, 0.4), high = d.between(0.12, 0.4), density = d.spread(20, 3000);
  const Vec3 low{-0.5 * side + d.between(-0.1, 0.1), y, -0.5 * side + d.between(-0.1, 0.1)};
  if (kind == "fem" || kind == "xpbd") {
    return {{{"type", kind},
             {"block", box_at(low, {side, high, side}, d.whole(1, 4))},
             {"density", density},
             {"youngs_modulus", d.spread(5e3, 1e6)},
             {"poisson_ratio", d.between(0, 0.4)}},
            density * side * side * high};
  }
  if (kind == "cloth" || kind == "net") {
    const int n = d.whole(3, 7);
    const double point = d.spread(1e-3, 0.1);
    return {{{"type", kind == "cloth" ? "xpbd" : "mass_spring"},
             {"cloth_grid", grid(side, y, n)},
             {"mass", point},
             {"stiffness", d.spread(1e3, 1e5)},
             {"thickness", 0.02}},
            point * n * n};
  }
  if (kind == "rope") {
    const int links = d.whole(3, 12);
    const double point = d.spread(1e-3, 0.3);
    return {
        {{"type", d.of({"xpbd", "mass_spring"})},
         {"rope", json::object{{"from", vec(low)}, {"to", vec(low + Vec3{side, 0, 0})}, {"links", links}}},
         {"mass", point},
         {"stiffness", d.spread(1e3, 1e5)},
         {"thickness", 0.02}},
        point * (links + 1)};
  }
  if (kind == "grains") {
    json::array points;
    const int n = d.whole(1, 12);
    for (int i = 0; i < n; ++i) points.push_back(vec(Vec3{0, y + 0.1, 0} + d.in_cube(0.1)));
    const double mass = d.spread(1e-3, 1);
    return {{{"type", "particles"}, {"positions", points}, {"mass", mass}, {"radius", 0.02}}, mass * n};
  }
  json::object b{{"type", d.of({"box", "sphere", "capsule", "cylinder"})},
                 {"position", vec(0, y + 0.3)},
                 {"axis", vec(d.direction())},
                 {"angle", d.between(0, 3)}};
  if (b["type"] == "box") {
    b["half_extents"] = vec(0.5 * side, 0.5 * high, 0.5 * side);
  } else {
    b["radius"] = 0.1;
    if (b["type"] != "sphere") b["half_length"] = 0.1;
  }
  b["density"] = density;
  return {{{"type", "rigid3d"}, {"bodies", json::array{b}}}, density * 0.01, false};
}

/// Two metres wide, its top at y = 0. A floor of bodies cannot be another system than the bodies that fall.
Thing holder(Dice& d, double load, bool points) {
  const std::string kind = points ? d.of({"cloth", "cloth", "net", "slab", "floor"})
                                  : d.of({"cloth", "net", "slab", "tank", "pool"});
  if (kind == "cloth" || kind == "net") {
    const int n = d.whole(6, 16);
    const double point = load * d.spread(0.1, 10) / (n * n);
    return {{{"type", kind == "cloth" ? "xpbd" : "mass_spring"},
             {"cloth_grid", grid(2, 0, n)},
             {"mass", point},
             {"stiffness", load * d.spread(1e3, 1e5)},
             {"thickness", 0.02},
             {"pinned", json::array{d.of({"corners", "border"})}}}};
  }
  if (kind == "slab") {
    const bool fem = d.chance(0.5);
    return {{{"type", fem ? "fem" : "xpbd"},
             {"block", box_at({-1, -0.5, -1}, {2, 0.5, 2}, d.whole(2, 6))},
             {"density", d.spread(20, 3000)},
             {"youngs_modulus", d.spread(1e5, 1e7)},
             {"pinned", json::array{fem ? "y0" : "bottom"}}}};
  }
  if (kind == "floor") {
    const json::object floor = d.chance(0.5) ? json::object{{"type", "plane"}, {"motion", "fixed"}}
                                             : json::object{{"type", "box"},
                                                            {"motion", "fixed"},
                                                            {"position", vec(0, -0.25)},
                                                            {"half_extents", vec(1, 0.25, 1)}};
    return {{{"type", "rigid3d"}, {"bodies", json::array{floor}}}, 0, false};
  }
  json::object water{{"center", vec(0, -0.4)}, {"half_extents", vec(0.5, 0.2, 0.5)}};
  if (kind == "tank") {
    return {{{"type", "sph"},
             {"low", vec(-0.5, -0.6, -0.5)},
             {"high", vec(0.5, 0.6, 0.5)},
             {"spacing", 0.1},
             {"bodies", json::array{water}}}};
  }
  water["material"] = "fluid", water["shape"] = "box";
  return {{{"type", "mpm"},
           {"dimension", 3},
           {"low", vec(-0.5, -0.6, -0.5)},
           {"high", vec(0.5, 0.6, 0.5)},
           {"cell", 0.1},
           {"bodies", json::array{water}}}};
}

}  // namespace

void falls(Dice& d, Trial& t) {
  const double height = d.between(0.02, 0.5);
  Thing a = faller(d, height);
  Thing b = holder(d, a.mass, a.points);
  const std::string type(b.system.at("type").as_string());
  const bool liquid = type == "sph" || type == "mpm";
  const bool forgotten = d.chance(0.1), swapped = !liquid && d.chance(0.5);
  json::array both = swapped ? json::array{b.system, a.system} : json::array{a.system, b.system};
  set_scene(t, d.of({1.0 / 60, 1.0 / 60, 1.0 / 60, 1.0 / 120}), kLong, kDown, std::move(both));
  if (!forgotten) {
    t.scene["couplings"] = json::array{
        json::object{{"type", liquid ? "immersion" : "contact"}, {"id", "c"}, {"a", "a"}, {"b", "b"}}};
  }
  const auto least = [&](const char* name, const char* system) {
    t.scene["probes"].as_array().push_back(json::object{
        {"id", name}, {"system", system}, {"rows", "least"}, {"fields", json::array{"position"}}});
  };
  least("thing", swapped ? "b" : "a");
  const bool sags = b.points && !liquid;
  if (sags) least("under", swapped ? "a" : "b");
  const double floor = liquid ? -0.6 : 0;
  expect_range(t, sags ? "thing.position.y - under.position.y" : "thing.position.y", floor - kThrough, 1e3,
               "what is under it holds it");
  t.rules.gain.reset();
  t.rules.event = Rules::Event::allowed;
  t.rules.unheld = Rules::Event::allowed;
}

}  // namespace truestep::campaign
