// Plates that fly and bars that turn against points at rest, without gravity: particles, cloth of springs and
// of xpbd. What moves is a rigid body, one that keyframes drive, a shape of keyframes, a bone of a skeleton.
// Nothing passes: with e = 0 and without friction every point goes on with what has hit it.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

/// Something thin that moves along x or turns about z.
struct Mover {
  std::string kind;
  double half_thickness, half_width;  ///< m
  double from = 0, speed = 0;         ///< m, m/s along x
  double rate = 0;                    ///< rad/s about z
};

json::array bodies_of(const Mover& m, const char* motion) {
  json::object body{{"type", "box"}, {"motion", motion}};
  body["half_extents"] = m.rate == 0 ? vec(m.half_thickness, m.half_width, m.half_width)
                                     : vec(m.half_width, m.half_thickness, m.half_width);
  body["position"] = vec(m.from, 0, 0);
  return {body};
}

/// A bone is thicker than the meshes of a cloth `wide` (m): threads slip round a thinner one without
/// friction.
Mover mover(Dice& d, double half_thickness, double half_width, double wide) {
  Mover m{d.of({"body", "body", "driven", "keyframes", "skeleton"}), half_thickness, half_width};
  if (m.kind == "skeleton") m.half_thickness = wide * d.between(0.3, 0.5);
  return m;
}

/// Adds the systems and couplings that move it; returns the id of the one that points meet.
const char* add_mover(Dice& d, const Mover& m, double seconds, json::array& systems, json::array& couplings) {
  const std::string& kind = m.kind;
  const std::string along = exact(m.from) + " + " + exact(m.speed) + "*t", turned = exact(m.rate) + "*t";
  if (kind == "body") {
    json::array bodies = bodies_of(m, "kinematic");
    json::object& body = bodies[0].as_object();
    body["velocity"] = vec(m.speed, 0, 0), body["angular_velocity"] = vec(0, 0, m.rate);
    systems.push_back(json::object{{"type", "rigid3d"}, {"bodies", bodies}});
    return "b";
  }
  if (kind == "driven") {
    systems.push_back(
        json::object{{"type", "rigid3d"}, {"bodies", bodies_of(m, d.of({"kinematic", "dynamic"}))}});
    json::object keys{{"type", "keyframes"}};
    json::object drive{{"type", "drive"}, {"id", "d"}, {"a", "c"}, {"b", "b"}, {"body", 0}};
    if (m.rate == 0) {
      const json::array points{vec(m.from, 0, 0), vec(m.from + m.speed * seconds, 0, 0)};
      keys["paths"] = json::array{json::object{{"name", "way"},
                                               {"times", json::array{0, seconds}},
                                               {"points", points},
                                               {"interpolation", "linear"}}};
      drive["path"] = "way";
    } else {
      // Quarter turns at most between keys.
      json::array times, turns;
      const int n = static_cast<int>(std::ceil(std::abs(m.rate) * seconds / 1.5)) + 1;
      for (int k = 0; k <= n; ++k) {
        const double t = k * seconds / n, half = 0.5 * m.rate * t;
        times.push_back(t);
        for (const double q : {std::cos(half), 0.0, 0.0, std::sin(half)}) turns.push_back(q);
      }
      keys["turns"] = json::array{json::object{{"name", "roll"}, {"times", times}, {"quaternions", turns}}};
      drive["turn"] = "roll";
    }
    systems.push_back(keys), couplings.push_back(drive);
    return "b";
  }
  if (kind == "keyframes") {
    json::object shape = bodies_of(m, "kinematic")[0].as_object();
    shape.erase("motion"), shape.erase("type");
    shape["id"] = "s", shape["shape"] = "box";
    shape["position"] = json::array{along}, shape["rotation"] = json::array{"0", "0", turned};
    systems.push_back(json::object{{"type", "keyframes"}, {"shapes", json::array{shape}}});
    return "b";
  }
  // A bone across the way, or from the middle outwards.
  json::object root{{"id", "root"}}, tip{{"id", "tip"}, {"parent", "root"}};
  json::object skeleton{{"type", "skeleton"}, {"bone_radius", m.half_thickness}};
  if (m.rate == 0) {
    skeleton["root_position"] = json::array{along, exact(-m.half_width)};
    tip["offset"] = vec(0, 2 * m.half_width, 0);
  } else {
    root["rotation"] = json::array{"0", "0", turned}, tip["offset"] = vec(m.half_width, 0, 0);
  }
  skeleton["joints"] = json::array{root, tip};
  systems.push_back(skeleton);
  return "b";
}

/// Points across the way in a plane through `middle` with the edges u and v; the probed row lies in its
/// middle.
json::object points(Dice& d, const Vec3& middle, const Vec3& u, const Vec3& v, double mass, int& row) {
  const std::string kind = d.of({"particles", "mass_spring", "xpbd"});
  json::object out{{"type", kind}, {"mass", mass}};
  if (kind == "particles") {
    const double radius = d.chance(0.5) ? 0 : norm(u) * d.between(0.02, 0.1);
    row = 0;
    out["radius"] = radius;
    json::array places{vec(middle)};
    for (int k = 0; k < 6; ++k)
      places.push_back(vec(middle + u * d.between(-0.4, 0.4) + v * d.between(-0.4, 0.4)));
    out["positions"] = places;
    return out;
  }
  const int n = 5;
  row = n * n / 2;
  out["cloth_grid"] = json::object{{"origin", vec(middle - u * 0.5 - v * 0.5)},
                                   {"edge_u", vec(u)},
                                   {"edge_v", vec(v)},
                                   {"nx", n},
                                   {"ny", n}};
  // Explicit methods hold it at 30 Hz.
  out["stiffness"] = 1, out["thickness"] = norm(u) * d.between(0.02, 0.1);
  if (kind == "mass_spring") out["shear_stiffness"] = 0.5, out["integrator"] = "velocity_verlet";
  return out;
}

void set_scene_of(Trial& t, Dice& d, double dt, double seconds, const Mover& m, const json::object& hit,
                  int row) {
  json::array systems{hit}, couplings;
  const double whole = dt * std::ceil(seconds / dt);
  const char* met = add_mover(d, m, whole + dt, systems, couplings);
  couplings.push_back(json::object{
      {"type", "contact"}, {"id", "k"}, {"a", "a"}, {"b", met}, {"restitution", 0}, {"friction", 0}});
  set_scene(t, dt, whole, {}, std::move(systems));
  t.scene["couplings"] = couplings;
  t.rules.gain.reset();
  probe(t, "hit", row, {"position", "velocity"});
}

}  // namespace

void shield_points(Dice& d, Trial& t) {
  const double wide = d.spread(0.1, 1), dt = usual_dt(d);
  Mover m = mover(d, wide * d.spread(0.005, 0.1), 1.5 * wide, wide);
  m.speed = wide / dt * d.spread(0.05, 10);
  const double gap = d.between(0.3, 4) * wide + d.unit() * m.speed * dt;
  m.from = -gap - m.half_thickness;
  int row = 0;
  const json::object hit = points(d, {}, {0, wide, 0}, {0, 0, wide}, 0.01, row);
  set_scene_of(t, d, dt, gap / m.speed + 4 * dt, m, hit, row);
  // A bone meets only a strip of a cloth, which the rest pulls back and forth.
  if (m.kind != "skeleton" || hit.at("type") == "particles") {
    expect_range(t, "hit.velocity.x", 0.98 * m.speed, 2 * m.speed, "it goes on with what has hit it");
  }
  expect_range(t, "hit.position.x - (" + exact(m.from) + " + " + exact(m.speed) + "*t)",
               0.5 * m.half_thickness, 1e9, "in front of it");
}

void bar_points(Dice& d, Trial& t) {
  const double dt = usual_dt(d), from = d.between(0.3, 0.7), wide = d.between(0.1, 0.5) * from;
  Mover m = mover(d, d.spread(0.005, 0.05), 1, wide);
  m.rate = std::min(d.spread(5, 60), 1.0 / dt) * d.sign();
  const double beside = std::asin(std::min(1.0, (wide * 0.2 + m.half_thickness) / from)) + 0.05;
  const double angle = beside + d.between(0, 1.2) + std::min(d.unit() * std::abs(m.rate) * dt, 0.3);
  const Vec3 out{std::cos(angle), std::copysign(std::sin(angle), m.rate), 0};
  int row = 0;
  const json::object hit = points(d, out * from, out * wide, {0, 0, wide}, 0.01, row);
  set_scene_of(t, d, dt, (angle + 0.4) / std::abs(m.rate) + 2 * dt, m, hit, row);
  // A bone meets only a strip of a cloth; what is passed stays at rest.
  const double share = m.kind != "skeleton" || hit.at("type") == "particles" ? 0.75 : 0.3;
  const double w = std::abs(m.rate);
  expect_range(t, "sqrt(hit.velocity.x^2 + hit.velocity.y^2)", share * w * (from - 0.5 * wide), 2 * w,
               "at least the bar's speed where it was hit");
}

}  // namespace truestep::campaign
