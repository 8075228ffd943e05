// What rests on surfaces that turn: turntables of every shape, discs of motors, drums in the plane. Boxes
// stay where they are; a ball that rolls without slip goes round a circle at 2/7 of the table's rate.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kG = 9.81;

/// A table with its top at y = 0 that turns about y.
json::object table(Dice& d, double rate, double friction) {
  const std::string kind = d.of({"cylinder", "box", "mesh", "height_field", "compound"});
  json::object out{
      {"type", kind}, {"motion", "kinematic"}, {"angular_velocity", vec(0, rate, 0)}, {"friction", friction}};
  const double r = 4;
  if (kind == "cylinder") {
    out["radius"] = r, out["half_length"] = 0.1, out["position"] = vec(0, -0.1, 0);
  } else if (kind == "box") {
    out["half_extents"] = vec(r, 0.1, r), out["position"] = vec(0, -0.1, 0);
  } else if (kind == "mesh") {
    out["vertices"] = json::array{vec(-r, 0, -r), vec(-r, 0, r), vec(r, 0, -r), vec(r, 0, r)};
    out["triangles"] = json::array{0, 1, 2, 2, 1, 3};
  } else if (kind == "height_field") {
    out["count"] = json::array{3, 3}, out["spacing"] = r, out["heights"] = json::array(9, 0.0);
  } else {
    out["parts"] = json::array{{{"type", "box"}, {"half_extents", vec(r, 0.1, r)}}};
    out["position"] = vec(0, -0.1, 0);
  }
  return out;
}

}  // namespace

void turntable_3d(Dice& d, Trial& t) {
  const double rate = d.sign() * d.spread(0.3, 6), from = d.between(0.05, 2.0), angle = d.between(0, 6.28);
  const double friction = std::max(0.3, 1.5 * rate * rate * from / kG), dt = usual_dt(d);
  const double size = d.between(0.05, 0.2), half = size * d.between(0.3, 0.6);
  const std::string kind = d.of({"box", "box", "cylinder", "hull"});
  json::object body{{"type", kind}, {"friction", friction}};
  const Vec3 place{from * std::cos(angle), half, -from * std::sin(angle)};
  body["position"] = vec(place), body["velocity"] = vec(cross(Vec3{0, rate, 0}, place));
  body["angular_velocity"] = vec(0, rate, 0);
  if (kind == "box") {
    body["half_extents"] = vec(size, half, size * d.between(0.8, 1));
  } else if (kind == "cylinder") {
    body["radius"] = size, body["half_length"] = half;
  } else {
    json::array points;
    for (const double y : {-half, half}) {
      for (int k = 0; k < 5; ++k)
        points.push_back(vec(size * std::cos(k * 1.2566), y, size * std::sin(k * 1.2566)));
    }
    body["points"] = points;
  }
  // A body twice as wide as high stands as long as the pull is below twice its weight.
  if (rate * rate * from / kG > 1) return turntable_3d(d, t);
  set_scene(t, dt, 20, {0, -kG, 0},
            {{{"type", "rigid3d"}, {"bodies", json::array{table(d, rate, friction), body}}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  if (d.chance(0.3)) system_of(t)["substeps"] = d.of({1, 10, 20});
  t.rules.gain.reset();
  probe(t, "rests", 1, {"position"});
  const std::string turned = exact(angle) + " + " + exact(rate) + "*t", c = "cos(" + turned + ")",
                    sine = "sin(" + turned + ")";
  const std::string out = "rests.position.x*" + c + " - rests.position.z*" + sine + " - " + exact(from),
                    along = "rests.position.x*" + sine + " + rests.position.z*" + c;
  for (const std::string& q : {out, along}) {
    expect_range(t, "largest(" + q + ")", 0, 1e-2 * size,
                 "it stays where it is on the table, but for how it sinks in and leans outwards at first");
    expect_range(t, "max(" + q + ", 4, 20) - min(" + q + ", 4, 20)", 0, 1e-3 * size, "nor does it creep");
  }
}

void rolling_table_3d(Dice& d, Trial& t) {
  const double rate = d.sign() * d.spread(0.5, 6), dt = usual_dt(d), size = d.between(0.05, 0.3);
  const double turn = 2 * rate / 7, loop = d.between(0.2, 0.8), heading = d.between(0, 6.28);
  const Vec3 speed = Vec3{std::cos(heading), 0, std::sin(heading)} * (loop * std::abs(turn));
  // The centre of its circle.
  const double off = d.between(0, 1), where = d.between(0, 6.28);
  const Vec3 middle{off * std::cos(where), size, off * std::sin(where)}, up{0, 1, 0};
  const Vec3 out = cross(up, speed) / -turn, place = middle + out;
  const Vec3 table_speed = cross(Vec3{0, rate, 0}, place);
  json::object body{{"type", "sphere"}, {"radius", size}, {"position", vec(place)}, {"velocity", vec(speed)}};
  body["angular_velocity"] = vec(cross(up, speed - table_speed) / size + Vec3{0, rate, 0});
  set_scene(t, dt, 3 * 2 * std::numbers::pi / std::abs(turn), {0, -kG, 0},
            {{{"type", "rigid3d"}, {"friction", 1}, {"bodies", json::array{table(d, rate, 1), body}}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  t.rules.gain.reset();
  probe(t, "ball", 1, {"position"});
  const std::string squared =
      "((ball.position.x - " + exact(middle.x) + ")^2 + (ball.position.z - " + exact(middle.z) + ")^2)";
  expect_range(t, "max(sqrt" + squared + ")", 0, 1.02 * loop, "a closed circle");
  expect_range(t, "min(sqrt" + squared + ")", 0.98 * loop, 1e9, "a closed circle");
}

/// A box on a disc that a motor turns.
void motor_disc_3d(Dice& d, Trial& t) {
  const double rate = d.sign() * d.spread(0.3, 4), from = d.between(0.1, 0.9), dt = usual_dt(d),
               size = d.between(0.05, 0.1);
  if (rate * rate * from / kG > 0.8) return motor_disc_3d(d, t);
  const Vec3 place{from, size, 0};
  json::object disc{{"type", d.of({"cylinder", "box"})},
                    {"position", vec(0, -0.1, 0)},
                    {"angular_velocity", vec(0, rate, 0)},
                    {"density", 20000}};
  if (disc["type"] == "box") {
    disc["half_extents"] = vec(1.5, 0.1, 1.5);
  } else {
    disc["radius"] = 1.5, disc["half_length"] = 0.1;
  }
  const json::object box{{"type", "box"},
                         {"half_extents", vec(size, size, size)},
                         {"position", vec(place)},
                         {"density", 100},
                         {"velocity", vec(cross(Vec3{0, rate, 0}, place))},
                         {"angular_velocity", vec(0, rate, 0)}};
  const json::object axle{
      {"type", "revolute"},  {"a", -1},         {"b", 0}, {"anchor", vec(0, 0, 0)}, {"axis", vec(0, 1, 0)},
      {"motor_speed", rate}, {"max_motor", 1e7}};
  set_scene(t, dt, 10, {0, -kG, 0},
            {{{"type", "rigid3d"},
              {"friction", 1},
              {"bodies", json::array{disc, box}},
              {"joints", json::array{axle}}}});
  t.rules.gain.reset();
  probe(t, "rests", 1, {"position"});
  const std::string r = "sqrt(rests.position.x^2 + rests.position.z^2)";
  expect_range(t, "largest(" + r + " - " + exact(from) + ")", 0, 0.02 * size,
               "it stays where it is on the disc");
}

/// Boxes against the inside of a drum that turns, without gravity, and on its outside arm: a plank.
void drum_2d(Dice& d, Trial& t) {
  const double rate = d.sign() * d.spread(0.5, 6), dt = usual_dt(d), size = d.between(0.1, 0.3);
  const double from = d.between(1, 3);
  const double angle = d.between(0, 6.28);
  const json::object drum{
      {"motion", "kinematic"},
      {"angle", angle},
      {"angular_velocity", rate},
      {"friction", 1},
      {"shapes",
       json::array{{{"type", "box"}, {"half_extents", vec(2, 0.2)}, {"center", vec(0, -from - size - 0.2)}},
                   {{"type", "box"}, {"half_extents", vec(2, 0.2)}, {"center", vec(0, from + size + 0.2)}}}}};
  const double aside = d.between(-0.4, 0.4) * from;
  const Vec3 own{aside, -from, 0};
  const Vec3 place{own.x * std::cos(angle) - own.y * std::sin(angle),
                   own.x * std::sin(angle) + own.y * std::cos(angle), 0};
  const json::object box{{"position", vec(place)},
                         {"angle", angle},
                         {"velocity", vec(-rate * place.y, rate * place.x)},
                         {"angular_velocity", rate},
                         {"friction", 1},
                         {"shapes", json::array{{{"type", "box"}, {"half_extents", vec(1.5 * size, size)}}}}};
  set_scene(t, dt, 10, {}, {{{"type", "rigid2d"}, {"bodies", json::array{drum, box}}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  t.rules.gain.reset();
  probe(t, "rests", 1, {"position"});
  const std::string c = "cos(" + exact(angle) + " + " + exact(rate) + "*t)",
                    s = "sin(" + exact(angle) + " + " + exact(rate) + "*t)";
  expect_range(t, "largest(rests.position.x*" + c + " + rests.position.y*" + s + " - " + exact(own.x) + ")",
               0, 0.02 * size, "it does not slide along");
}

}  // namespace truestep::campaign
