// Falling bodies: columns of bodies with mixed restitution, and heaps in a pit.
#include <algorithm>
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

/// One bounce for all, or one for each.
struct Bounce {
  explicit Bounce(Dice& d) : mixed(d.chance(0.7)), common(d.of({0.0, 0.2, 0.5, 0.8, 1.0})) {}
  double operator()(Dice& d) const { return mixed ? d.of({0.0, 0.0, 0.0, 0.5, 0.8, 0.95, 1.0}) : common; }
  bool mixed;
  double common;
};

json::object surface(Dice& d, const Bounce& bounce) {
  return {{"friction", d.between(0, 1)}, {"restitution", bounce(d)}, {"density", d.spread(100, 5000)}};
}

json::object fixed_box_2d(Dice& d, const Bounce& bounce, const Vec3& at, const Vec3& half) {
  json::object b = surface(d, bounce);
  b["motion"] = "fixed", b["position"] = vec(at);
  b["shapes"] = json::array{{{"type", "box"}, {"half_extents", vec(half)}}};
  return b;
}

/// A disk or a box; `size` is half its height when not rotated.
json::object body_2d(Dice& d, const Bounce& bounce, const Vec3& at, double size, const char* form) {
  json::object b = surface(d, bounce);
  b["position"] = vec(at);
  const std::string kind = form;
  if (kind == "circle") {
    b["shapes"] = json::array{{{"type", "circle"}, {"radius", size}}};
  } else if (kind == "capsule") {
    const double half = d.between(0.2, 1) * size;
    b["shapes"] =
        json::array{{{"type", "capsule"}, {"from", vec(-half, 0)}, {"to", vec(half, 0)}, {"radius", size}}};
  } else {
    b["shapes"] = json::array{{{"type", "box"}, {"half_extents", vec(d.between(0.6, 1.6) * size, size)}}};
  }
  return b;
}

json::object body_3d(Dice& d, const Bounce& bounce, const Vec3& at, double size, const char* form) {
  json::object b = surface(d, bounce);
  b["type"] = form, b["position"] = vec(at);
  const std::string kind = form;
  if (kind == "box") {
    b["half_extents"] = vec(d.between(0.6, 1.6) * size, size, d.between(0.6, 1.6) * size);
  } else if (kind == "sphere") {
    b["radius"] = size;
  } else if (kind == "capsule") {
    b["radius"] = 0.6 * size, b["half_length"] = 0.4 * size;
  } else {
    b["radius"] = d.between(0.6, 1.2) * size, b["half_length"] = size;
  }
  return b;
}

/// J that it takes to lift a turned box out of the floor, y = 0, where its lowest corner begins below it.
double lift_out_of_floor(const json::object& box, const Vec3& at, const Vec3& axis, double angle) {
  const auto& half = box.at("half_extents").as_array();
  const double hx = half[0].to_number<double>(), hy = half[1].to_number<double>(),
               hz = half[2].to_number<double>();
  const double c = std::cos(angle), s = std::sin(angle);
  const double depth = std::abs(axis.y * axis.x * (1 - c) + axis.z * s) * hx +
                       std::abs(c + axis.y * axis.y * (1 - c)) * hy +
                       std::abs(axis.y * axis.z * (1 - c) - axis.x * s) * hz - at.y;
  return std::max(0.0, depth) * box.at("density").to_number<double>() * 8 * hx * hy * hz * -kDown.y;
}

/// Bodies over one another: the lowest lies on the floor, the others follow at gaps.
template <class Add>
void column(Dice& d, Add add) {
  const int n = d.whole(2, 4);
  double top = 0;
  for (int i = 0; i < n; ++i) {
    const double size = d.between(0.1, 0.5), gap = i == 0 ? 0 : d.of({0.0, 0.35, 0.7, 1.5});
    add(i, Vec3{d.between(-0.05, 0.05), top + gap + size, 0}, size);
    top += gap + 2 * size;
  }
}

}  // namespace

void drop_2d(Dice& d, Trial& t) {
  const Bounce bounce(d);
  json::array bodies{fixed_box_2d(d, bounce, {0, -0.5, 0}, {20, 0.5, 0})};
  column(d, [&](int i, const Vec3& at, double size) {
    bodies.push_back(body_2d(d, bounce, at, size, i == 0 ? "box" : d.of({"circle", "box", "capsule"})));
  });
  set_scene(t, usual_dt(d), 4, kDown, {{{"type", "rigid2d"}, {"bodies", bodies}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
}

void drop_3d(Dice& d, Trial& t) {
  const Bounce bounce(d);
  json::object floor = surface(d, bounce);
  floor["type"] = "plane", floor["motion"] = "fixed";
  json::array bodies{floor};
  column(d, [&](int i, const Vec3& at, double size) {
    bodies.push_back(
        body_3d(d, bounce, at, size, i == 0 ? "box" : d.of({"sphere", "box", "capsule", "cylinder"})));
  });
  set_scene(t, usual_dt(d), 4, kDown, {{{"type", "rigid3d"}, {"bodies", bodies}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
}

void pile_2d(Dice& d, Trial& t) {
  const Bounce bounce(d);
  json::array bodies{fixed_box_2d(d, bounce, {0, -1, 0}, {4, 1, 0}),
                     fixed_box_2d(d, bounce, {-3, 6, 0}, {1, 6, 0}),
                     fixed_box_2d(d, bounce, {3, 6, 0}, {1, 6, 0})};
  const int n = d.whole(5, 20);
  for (int i = 0; i < n; ++i) {
    const Vec3 at{-1.3 + 1.3 * (i % 3) + d.between(-0.05, 0.05), 0.7 + 1.3 * (i / 3), 0};
    bodies.push_back(body_2d(d, bounce, at, d.between(0.2, 0.35), d.of({"circle", "box", "capsule"})));
    bodies.back().as_object()["angle"] = d.between(-3, 3);
  }
  set_scene(t, usual_dt(d), 2, kDown, {{{"type", "rigid2d"}, {"bodies", bodies}}});
  expect_range(t, "a.penetration", 0, 0.05, "a quarter of the smallest body's half height");
  t.rules.still = 0.01;
}

void pile_3d(Dice& d, Trial& t) {
  const Bounce bounce(d);
  json::object floor = surface(d, bounce);
  floor["type"] = "plane", floor["motion"] = "fixed";
  json::array bodies{floor};
  for (const double side : {-1.0, 1.0}) {
    json::object wall = surface(d, bounce);
    wall["type"] = "box", wall["motion"] = "fixed";
    wall["position"] = vec(side * 2.5, 5, 0), wall["half_extents"] = vec(0.5, 5, 3);
    bodies.push_back(wall);
    wall["position"] = vec(0, 5, side * 2.5), wall["half_extents"] = vec(2, 5, 0.5);
    bodies.push_back(wall);
  }
  const int n = d.whole(5, 16);
  for (int i = 0; i < n; ++i) {
    const Vec3 at{-0.9 + 1.8 * (i % 2) + d.between(-0.1, 0.1), 0.9 + 1.5 * (i / 4),
                  -0.9 + 1.8 * (i / 2 % 2) + d.between(-0.1, 0.1)};
    bodies.push_back(
        body_3d(d, bounce, at, d.between(0.25, 0.4), d.of({"sphere", "box", "capsule", "cylinder"})));
    json::object& b = bodies.back().as_object();
    const Vec3 axis = d.direction();
    const double angle = d.between(-3, 3);
    b["axis"] = vec(axis), b["angle"] = angle;
    if (b.at("type") == "box") t.rules.drives += lift_out_of_floor(b, at, axis, angle);
  }
  set_scene(t, usual_dt(d), 2, kDown, {{{"type", "rigid3d"}, {"bodies", bodies}}});
  expect_range(t, "a.penetration", 0, 0.05, "a fifth of the smallest body's half height");
  t.rules.still = 0.01;
}

}  // namespace truestep::campaign
