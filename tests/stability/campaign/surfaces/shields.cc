// Thin shields that move fast against bodies at rest, without gravity: plates that fly, and bars that turn.
// Nothing passes: what is hit leaves with at least the shield's speed, e = 0 and without friction.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

/// What is hit, at p; `size` is the radius of the largest ball inside.
json::object target(Dice& d, bool flat, double size, const Vec3& p) {
  json::object body{{"position", vec(p)}, {"friction", 0}, {"density", 1}};
  const std::string kind = d.of({"round", "round", "box", "capsule"});
  if (flat) {
    json::object shape{{"type", kind == "round" ? "circle" : kind}};
    if (kind == "box") {
      shape["half_extents"] = vec(size, size * d.between(1, 2));
    } else {
      shape["radius"] = size;
      if (kind == "capsule") shape["from"] = vec(-size, 0), shape["to"] = vec(size, 0);
    }
    body["shapes"] = json::array{shape};
    body["angle"] = d.between(0, 3);
    return body;
  }
  body["type"] = kind == "round" ? "sphere" : kind;
  if (kind == "box") {
    body["half_extents"] = vec(size, size * d.between(1, 2), size);
  } else {
    body["radius"] = size;
    if (kind == "capsule") body["half_length"] = size;
  }
  body["axis"] = vec(d.direction()), body["angle"] = d.between(0, 3);
  return body;
}

json::object shield(bool flat, const std::string& motion, const Vec3& half) {
  json::object body{{"motion", motion}, {"friction", 0}};
  const json::array extents = flat ? vec(half.x, half.y) : vec(half);
  if (flat) {
    body["shapes"] = json::array{{{"type", "box"}, {"half_extents", extents}}};
  } else {
    body["type"] = "box", body["half_extents"] = extents;
  }
  // Ten thousand times as heavy as the heaviest target.
  if (motion == "dynamic") body["density"] = 1e7;
  // In the plane only a bullet does not pass through others.
  if (flat && motion == "dynamic") body["bullet"] = true;
  return body;
}

void set_shield_scene(Trial& t, Dice& d, bool flat, double dt, double seconds, json::array bodies) {
  json::object system{
      {"type", flat ? "rigid2d" : "rigid3d"}, {"bodies", std::move(bodies)}, {"restitution", 0}};
  if (d.chance(0.2)) system["precision"] = "f64";
  if (d.chance(0.2)) system["substeps"] = d.of({1, 8, 16});
  set_scene(t, dt, dt * std::ceil(seconds / dt), {}, {system});
  t.rules.gain.reset();
  probe(t, "hit", 1, {"position", "velocity"});
}

/// A plate of 0.2 to 5 cm flies along x.
void plate(Dice& d, Trial& t, bool flat) {
  const double size = d.spread(0.02, 0.5), thick = d.spread(0.001, 0.025), dt = usual_dt(d);
  const double speed = size / dt * d.spread(0.3, 20);
  const double gap = d.between(1, 8) * size + d.unit() * speed * dt;
  json::object plate = shield(flat, d.of({"kinematic", "kinematic", "dynamic"}), {thick, 4 * size, 4 * size});
  plate["position"] = vec(-gap - thick, d.between(-1, 1) * size, 0), plate["velocity"] = vec(speed, 0, 0);
  const double off = flat ? 0 : d.between(-1, 1) * size;
  set_shield_scene(t, d, flat, dt, gap / speed + 6 * dt, {plate, target(d, flat, size, {0, 0, off})});
  probe(t, "plate", 0, {"position"});
  // A light body beside the plate's middle turns a heavy one no more than this.
  expect_range(t, "hit.velocity.x", 0.98 * speed, 3 * speed,
               "what is hit without restitution goes on with the plate");
  expect_range(t, "hit.position.x - plate.position.x", 0.8 * size, 1e9, "in front of it");
}

/// A bar turns about z; the target rests beside it.
void bar(Dice& d, Trial& t, bool flat) {
  const double half = 1, thick = d.spread(0.005, 0.05), size = d.spread(0.03, 0.15), dt = usual_dt(d);
  const double rate = std::min(d.spread(5, 60), 1.0 / dt) * d.sign();
  const double from = d.between(0.3, 0.9) * half;
  const double beside = std::asin(std::min(1.0, (2.5 * size + thick) / from));
  const double angle = beside + d.between(0, 1.2) + std::min(d.unit() * std::abs(rate) * dt, 0.3);
  const std::string motion = d.of({"kinematic", "kinematic", "dynamic"});
  json::object bar = shield(flat, motion, {half, thick, flat ? 0 : 2 * size});
  if (flat) {
    bar["angular_velocity"] = rate;
  } else {
    bar["angular_velocity"] = vec(0, 0, rate);
  }
  const Vec3 place{from * std::cos(angle), std::copysign(from * std::sin(angle), rate), 0};
  const double seconds = (angle + 0.4) / std::abs(rate) + 2 * dt;
  set_shield_scene(t, d, flat, dt, seconds, {bar, target(d, flat, size, place)});
  const double w = std::abs(rate);
  const char* speed = "sqrt(hit.velocity.x^2 + hit.velocity.y^2)";
  expect_range(t, speed, 0.75 * w * (from - 1.5 * size), 2 * w * (half + 2 * size),
               "at least the bar's speed where it was hit, at most that of the tip along and across");
}

/// What moves first is driven by keys instead of its velocities: a path or a turn at the same rate.
void drive(Trial& t) {
  json::object& body = system_of(t)["bodies"].as_array()[0].as_object();
  const double seconds = t.scene["time"].at("duration").as_double() + 1;
  json::object keys{{"type", "keyframes"}, {"id", "keys"}};
  json::object drive{{"type", "drive"}, {"id", "d"}, {"a", "keys"}, {"b", "a"}, {"body", 0}};
  if (body.contains("velocity")) {
    const double from = body["position"].as_array()[0].as_double(),
                 speed = body["velocity"].as_array()[0].as_double();
    keys["paths"] =
        json::array{json::object{{"name", "way"},
                                 {"times", json::array{0, seconds}},
                                 {"points", json::array{vec(from, 0, 0), vec(from + speed * seconds, 0, 0)}},
                                 {"interpolation", "linear"}}};
    drive["path"] = "way", body.erase("velocity");
  } else {
    const double rate = body["angular_velocity"].as_array()[2].as_double();
    json::array times, turns;
    const int n = static_cast<int>(std::ceil(std::abs(rate) * seconds / 1.5)) + 1;
    for (int k = 0; k <= n; ++k) {
      const double at = k * seconds / n, half = 0.5 * rate * at;
      times.push_back(at);
      for (const double q : {std::cos(half), 0.0, 0.0, std::sin(half)}) turns.push_back(q);
    }
    keys["turns"] = json::array{json::object{{"name", "roll"}, {"times", times}, {"quaternions", turns}}};
    drive["turn"] = "roll", body.erase("angular_velocity");
  }
  t.scene["systems"].as_array().push_back(keys);
  t.scene["couplings"] = json::array{drive};
}

}  // namespace

void driven_shield_3d(Dice& d, Trial& t) {
  plate(d, t, false), drive(t);
}
void driven_bar_3d(Dice& d, Trial& t) {
  bar(d, t, false), drive(t);
}
void shield_2d(Dice& d, Trial& t) {
  plate(d, t, true);
}
void shield_3d(Dice& d, Trial& t) {
  plate(d, t, false);
}
void bar_2d(Dice& d, Trial& t) {
  bar(d, t, true);
}
void bar_3d(Dice& d, Trial& t) {
  bar(d, t, false);
}

}  // namespace truestep::campaign
