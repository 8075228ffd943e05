// Soft things and rigid bodies in space joined by one coupling, at defaults: closed and undamped, with masses
// from a thousandth to ten thousand times each other and stiffness over several powers of ten. Nothing may
// gain energy in silence: a scene holds, ends with an event, or is refused.
#include <algorithm>
#include <array>
#include <vector>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

/// A soft system about the origin, within `reach` m of it, at the height 0 where bodies can fall on it.
struct SoftThing {
  json::object system;
  double mass;            ///< kg, of all of it
  double top;             ///< m, above the origin
  std::vector<int> ends;  ///< points that bodies are tied to
  Vec3 end;               ///< m, where the first of them is
};

json::object grid(double side, int n) {
  return {{"origin", vec(-0.5 * side, 0, -0.5 * side)},
          {"edge_u", vec(side, 0, 0)},
          {"edge_v", vec(0, 0, side)},
          {"nx", n},
          {"ny", n}};
}

/// A cloth of xpbd or springs.
SoftThing cloth_of(Dice& d, const char* type, double stiffest) {
  const double side = d.between(0.6, 1.6), point = d.spread(1e-4, 0.3), k = d.spread(100, stiffest);
  const double thick = d.between(0.01, 0.04);
  const int n = d.whole(4, 8);
  json::object s{{"type", type},
                 {"cloth_grid", grid(side, n)},
                 {"mass", point},
                 {"stiffness", k},
                 {"shear_stiffness", k * d.between(0, 0.5)},
                 {"thickness", thick}};
  if (d.chance(0.7)) s["pinned"] = json::array{d.of({"corners", "corners", "border"})};
  return {std::move(s), point * n * n, 0.5 * thick, {n * n / 2, n * n / 2 + 1, n / 2}, {}};
}

SoftThing rope_of(Dice& d, const char* type, double stiffest) {
  const double half = d.between(0.3, 1), point = d.spread(1e-4, 1), thick = d.between(0.01, 0.04);
  const int links = d.whole(3, 20);
  json::object s{{"type", type},
                 {"rope", json::object{{"from", vec(-half, 0)}, {"to", vec(half, 0)}, {"links", links}}},
                 {"mass", point},
                 {"stiffness", d.spread(100, stiffest)},
                 {"thickness", thick}};
  if (d.chance(0.7)) s["pinned"] = json::array{"first"};
  return {std::move(s), point * (links + 1), 0.5 * thick, {links, links - 1, links / 2}, {half, 0, 0}};
}

/// A block of tetrahedra (xpbd) or bricks (fem).
SoftThing block_of(Dice& d, const char* type) {
  const double side = d.between(0.3, 0.8), high = side * d.between(0.3, 1), density = d.spread(5, 3000);
  const int n = d.whole(1, 4), up = d.whole(1, 2);
  json::object s{{"type", type},
                 {"block", json::object{{"origin", vec(-0.5 * side, -high, -0.5 * side)},
                                        {"size", vec(side, high, side)},
                                        {"cells_x", n},
                                        {"cells_y", up},
                                        {"cells_z", n}}},
                 {"density", density},
                 {"youngs_modulus", d.spread(1e3, 1e7)},
                 {"poisson_ratio", d.between(0, 0.45)}};
  if (d.chance(0.7)) s["pinned"] = json::array{std::string(type) == "fem" ? "y0" : "bottom"};
  return {std::move(s), density * side * side * high, 0.01, {-1, -2, -3}, {0.5 * side, 0, 0.5 * side}};
}

/// A membrane or a shell of finite elements.
SoftThing sheet_of(Dice& d) {
  const double half = d.between(0.3, 0.8), thick = d.spread(0.5e-3, 0.02), density = d.spread(50, 3000);
  const int n = d.whole(2, 6), row = n + 1;
  const bool shell = d.chance(0.5);
  json::array vertices, cells;
  for (int j = 0; j < row; ++j) {
    for (int i = 0; i < row; ++i)
      vertices.push_back(vec(half * (2.0 * i / n - 1), 0, half * (2.0 * j / n - 1)));
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int at = j * row + i;
      for (const int corner : shell ? std::vector{at, at + row, at + row + 1, at, at + row + 1, at + 1}
                                    : std::vector{at, at + row, at + row + 1, at + 1})
        cells.push_back(corner);
    }
  }
  json::object s{
      {"type", "fem"},
      {"plane", shell ? "shell" : "membrane"},
      {"plane_thickness", thick},
      {"mesh",
       json::object{{"vertices", vertices}, {"cells", cells}, {"form", shell ? "triangles" : "quadrangles"}}},
      {"density", density},
      {"youngs_modulus", d.spread(1e4, 1e8)},
      {"poisson_ratio", d.between(0, 0.45)}};
  if (d.chance(0.7)) s["pinned"] = json::array{"border"};
  if (shell) s["element"] = "tri6";
  const int middle = row * row / 2;
  return {std::move(s), density * thick * 4 * half * half, 0.01, {middle, middle - 1, middle - 2}, {}};
}

/// A free net of points and springs between neighbours and some others.
SoftThing net_of(Dice& d) {
  json::array points, springs, masses;
  const int n = d.whole(4, 12);
  double mass = 0;
  for (int i = 0; i < n; ++i) {
    points.push_back(vec(Vec3{0, -0.6, 0} + d.in_cube(0.5)));
    masses.push_back(d.spread(1e-3, 1)), mass += masses.back().to_number<double>();
    for (int k = 0; k < 2 && i > k; ++k)
      springs.push_back(json::object{{"a", k == 0 ? i - 1 : d.whole(0, i - 2)}, {"b", i}});
  }
  json::object s{{"type", "mass_spring"},
                 {"free", json::object{{"points", points}, {"masses", masses}, {"springs", springs}}},
                 {"stiffness", d.spread(10, 1e6)},
                 {"thickness", 0.03}};
  if (d.chance(0.5)) s["pins"] = json::array{0};
  return {std::move(s), mass, 0, {n - 1, n - 2, n / 2}, {0, 0, 0}};
}

enum class Soft : uint8_t {
  xpbd_cloth,
  xpbd_rope,
  xpbd_block,
  fem_block,
  fem_sheet,
  spring_cloth,
  spring_rope,
  spring_net
};
enum class Tie : uint8_t { contact, spring, rigid };

SoftThing soft(Dice& d, Soft kind) {
  switch (kind) {
    case Soft::xpbd_cloth:
      return cloth_of(d, "xpbd", 1e6);
    case Soft::xpbd_rope:
      return rope_of(d, "xpbd", 1e7);
    case Soft::xpbd_block:
      return block_of(d, "xpbd");
    case Soft::fem_block:
      return block_of(d, "fem");
    case Soft::fem_sheet:
      return sheet_of(d);
    case Soft::spring_cloth:
      return cloth_of(d, "mass_spring", 1e5);
    case Soft::spring_rope:
      return rope_of(d, "mass_spring", 1e6);
    case Soft::spring_net:
      return net_of(d);
  }
  return {};
}

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
