// What belts, lifts and drums in space carry: bodies come to rest on them and stay there. A box that is put
// on a belt slips for v / (mu g) and then rides along; on a lift it stays where it is, whatever way that goes
// at a constant speed or on a curve of keys; in a drum the wall presses it inwards.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kWeight = 9.81;

/// A box with the extents `half` at p.
json::object box(bool flat, const Vec3& half, const Vec3& p) {
  json::object body{{"position", flat ? vec(p.x, p.y) : vec(p)}};
  if (flat) {
    body["shapes"] = json::array{{{"type", "box"}, {"half_extents", vec(half.x, half.y)}}};
  } else {
    body["type"] = "box", body["half_extents"] = vec(half);
  }
  return body;
}

void set_carrier_scene(Trial& t, Dice& d, bool flat, double seconds, json::array bodies) {
  set_scene(t, usual_dt(d), seconds, {0, -kWeight, 0},
            {{{"type", flat ? "rigid2d" : "rigid3d"}, {"bodies", std::move(bodies)}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  t.rules.gain.reset();
  probe(t, "load", 1, {"position"});
}

void belt(Dice& d, Trial& t, bool flat) {
  const double size = d.between(0.05, 0.3), mu = d.between(0.2, 1), speed = d.sign() * d.spread(0.1, 4);
  const bool rides = d.chance(0.5);
  const double slips = rides ? 0 : std::abs(speed) / (mu * kWeight), seconds = slips + 4;
  json::object belt = box(flat, {40, 0.5, 2}, {0, -0.5, 0});
  belt["motion"] = "fixed", belt["friction"] = mu;
  if (flat) {
    belt["surface_speed"] = speed;
  } else {
    belt["surface_velocity"] = vec(speed, 0, 0);
  }
  // Low enough not to tip over while it slips.
  const double half = size * d.between(0.2, 0.6);
  json::object load = box(flat, {size, half, size * d.between(0.6, 1)}, {0, half, 0});
  load["friction"] = mu;
  if (rides) load["velocity"] = flat ? vec(speed, 0) : vec(speed, 0, 0);
  set_carrier_scene(t, d, flat, seconds, {belt, load});
  const std::string x = "load.position.x - " + exact(speed) + "*t";
  const double lag = 0.5 * speed * slips;
  char after[64];
  std::snprintf(after, sizeof after, "%.6f, %.6f", slips + 1, seconds);
  const double dt = t.scene["time"].at("dt").as_double();
  expect_range(t, "largest(" + x + " + " + exact(lag) + ", " + after + ")", 0,
               0.01 * size + 0.5 * mu * kWeight * dt * dt + 0.01 * std::abs(lag), "it slips for v / (mu g)");
  expect_range(t, "max(" + x + ", " + after + ") - min(" + x + ", " + after + ")", 0, 1e-3 * size,
               "then it rides along");
}

/// A platform at a constant velocity.
void lift(Dice& d, Trial& t, bool flat) {
  const double size = d.between(0.05, 0.3), half = size * d.between(0.3, 2), speed = d.spread(0.1, 10);
  const Vec3 way = flat ? normalized(Vec3{d.between(-1, 1), d.between(-1, 1), 0}) : d.direction();
  const Vec3 v = way * speed;
  json::object floor = box(flat, {2, 0.1, 2}, {0, -0.1, 0});
  json::object load = box(flat, {size, half, size}, {d.between(-1, 1), half, 0});
  const double x0 = load["position"].as_array()[0].as_double();
  floor["motion"] = "kinematic";
  for (json::object* b : {&floor, &load})
    (*b)["velocity"] = flat ? vec(v.x, v.y) : vec(v), (*b)["friction"] = 0.6;
  set_carrier_scene(t, d, flat, 5, {floor, load});
  expect_range(t, "largest(load.position.x - " + exact(x0) + " - " + exact(v.x) + "*t)", 0, 2e-3 * size,
               "it stays where it is");
  expect_range(t, "largest(load.position.y - " + exact(half) + " - " + exact(v.y) + "*t)", 0,
               0.02 * half + 1e-3, "nor does it sink in");
  if (!flat)
    expect_range(t, "largest(load.position.z - " + exact(v.z) + "*t)", 0, 2e-3 * size,
                 "it stays where it is");
}

}  // namespace

void belt_2d(Dice& d, Trial& t) {
  belt(d, t, true);
}
void belt_3d(Dice& d, Trial& t) {
  belt(d, t, false);
}
void lift_2d(Dice& d, Trial& t) {
  lift(d, t, true);
}
void lift_3d(Dice& d, Trial& t) {
  lift(d, t, false);
}

/// Boxes against the inside of a drum about z in space, without gravity.
void drum_3d(Dice& d, Trial& t) {
  const double rate = d.sign() * d.spread(0.5, 6), size = d.between(0.1, 0.3), from = d.between(1, 3),
               angle = d.between(0, 6.28), aside = d.between(-0.4, 0.4) * from;
  const auto wall = [&](double y) {
    return json::object{{"type", "box"}, {"half_extents", vec(2, 0.2, 2)}, {"position", vec(0, y, 0)}};
  };
  const double y = from + size + 0.2;
  const json::array z_axis = vec(0, 0, 1);
  const json::object drum{{"type", "compound"},
                          {"motion", "kinematic"},
                          {"axis", z_axis},
                          {"angle", angle},
                          {"angular_velocity", vec(0, 0, rate)},
                          {"friction", 1},
                          {"parts", json::array{wall(-y), wall(y)}}};
  const Vec3 own{aside, -from, 0};
  const double c0 = std::cos(angle), s0 = std::sin(angle);
  const Vec3 place{own.x * c0 - own.y * s0, own.x * s0 + own.y * c0, 0};
  const json::object load{{"type", "box"},
                          {"half_extents", vec(1.5 * size, size, 1.2 * size)},
                          {"position", vec(place)},
                          {"axis", z_axis},
                          {"angle", angle},
                          {"velocity", vec(-rate * place.y, rate * place.x, 0)},
                          {"angular_velocity", vec(0, 0, rate)},
                          {"friction", 1}};
  set_scene(t, usual_dt(d), 10, {}, {{{"type", "rigid3d"}, {"bodies", json::array{drum, load}}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  t.rules.gain.reset();
  probe(t, "rests", 1, {"position"});
  const std::string turned = exact(angle) + " + " + exact(rate) + "*t", c = "cos(" + turned + ")",
                    s = "sin(" + turned + ")";
  expect_range(t, "largest(rests.position.x*" + c + " + rests.position.y*" + s + " - " + exact(own.x) + ")",
               0, 0.02 * size, "it does not slide along");
  expect_range(t, "largest(rests.position.z)", 0, 0.02 * size, "nor aside");
}

}  // namespace truestep::campaign
