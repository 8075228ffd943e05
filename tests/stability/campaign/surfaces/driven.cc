// What bodies carry that a drive leads along paths and turns: lifts, tables that turn to and fro, swings.
// With enough friction a load stays where it is, however often its carrier speeds up and slows down.
#include <algorithm>
#include <functional>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kPull = 9.81;

/// Where a carrier is at a time: its path and, as an angle about an axis, its turn.
struct Guide {
  std::function<Vec3(double)> path;
  std::function<double(double)> angle;
  Vec3 axis;
};

/// A load on a floor that is led, for `seconds`; keys begin before the start, so that all is in motion.
void set_led_scene(Trial& t, Dice& d, const Guide& guide, json::object floor, json::object load,
                   double seconds) {
  constexpr int kKeys = 420;
  const double spacing = seconds / 400;
  floor["motion"] = d.of({"kinematic", "kinematic", "dynamic"});
  floor["friction"] = 1, load["friction"] = 1;
  set_scene(t, usual_dt(d), seconds, {0, -kPull, 0},
            {{{"type", "rigid3d"}, {"bodies", json::array{floor, load}}}});
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
  t.rules.gain.reset();
  probe(t, "load", 1, {"position", "orientation"});
  json::array times, points, quaternions;
  for (int k = -10; k < kKeys - 10; ++k) {
    const double at = k * spacing;
    times.push_back(at);
    if (guide.path) points.push_back(vec(guide.path(at)));
    if (!guide.angle) continue;
    const double half = 0.5 * guide.angle(at), s = std::sin(half);
    for (const double q : {std::cos(half), guide.axis.x * s, guide.axis.y * s, guide.axis.z * s})
      quaternions.push_back(q);
  }
  json::object keys{{"type", "keyframes"}, {"id", "b"}};
  json::object drive{{"type", "drive"}, {"id", "d"}, {"a", "b"}, {"b", "a"}, {"body", 0}};
  if (guide.path) {
    keys["paths"] = json::array{json::object{{"name", "way"}, {"times", times}, {"points", points}}};
    drive["path"] = "way";
  }
  if (guide.angle) {
    // With slerp the spin would jump at every key, as far as friction does not reach in a short step.
    keys["turns"] = json::array{json::object{
        {"name", "turn"}, {"times", times}, {"quaternions", quaternions}, {"interpolation", "squad"}}};
    drive["turn"] = "turn";
  }
  t.scene["systems"].as_array().push_back(keys);
  t.scene["couplings"] = json::array{drive};
}

/// A box, a cylinder on its face or a hull, `half` high.
json::object low_load(Dice& d, double size, double half) {
  const std::string kind = d.of({"box", "box", "cylinder", "hull"});
  json::object out{{"type", kind}};
  if (kind == "box") {
    out["half_extents"] = vec(size, half, size * d.between(0.8, 1));
  } else if (kind == "cylinder") {
    out["radius"] = size, out["half_length"] = half;
  } else {
    json::array points;
    for (const double y : {-half, half}) {
      for (int k = 0; k < 5; ++k)
        points.push_back(vec(size * std::cos(k * 1.2566), y, size * std::sin(k * 1.2566)));
    }
    out["points"] = points;
  }
  return out;
}

json::object plate(double size) {
  return {{"type", "box"}, {"half_extents", vec(size, 0.1, size)}, {"position", vec(0, -0.1, 0)}};
}

}  // namespace

/// A platform that keys drive up and down and to and fro, with up to 0.4 g. It starts at a turning point.
void driven_lift_3d(Dice& d, Trial& t) {
  const double size = d.between(0.05, 0.3), half = size * d.between(0.2, 0.6), rate = d.spread(0.5, 6);
  const double most = d.between(0.05, 0.4) * kPull / (rate * rate);
  const double up = most * d.unit(), aside = most * d.between(-0.5, 0.5), phase = d.between(0, 6.28);
  json::object load = low_load(d, size, half);
  load["position"] = vec(0, half, 0);
  const auto way = [=](double at) {
    const double c = std::cos(rate * at) - 1;
    return Vec3{aside * std::cos(phase) * c, up * c, aside * std::sin(phase) * c};
  };
  set_led_scene(t, d, {way, {}, {}}, plate(3), load, 5);
  const std::string c = "(cos(" + exact(rate) + "*t) - 1)";
  const std::string x = "load.position.x - " + exact(aside * std::cos(phase)) + "*" + c,
                    z = "load.position.z - " + exact(aside * std::sin(phase)) + "*" + c;
  for (const std::string& q : {x, z})
    expect_range(t, "largest(" + q + ")", 0, 2e-3 * size, "it stays where it is, but for how it leans");
}

/// A table that keys turn to and fro about its axis.
void driven_table_3d(Dice& d, Trial& t) {
  const double size = d.between(0.05, 0.2), half = size * d.between(0.3, 0.6), from = d.between(0.05, 2),
               rate = d.spread(0.5, 6);
  // Both pulls, outwards and along, are at most 0.3 g.
  const double along = 0.3 * kPull / (rate * rate * from), out = std::sqrt(0.3 * kPull / from) / rate;
  const double swing = d.sign() * std::min({along, out, 3.0}) * d.between(0.1, 1);
  json::object load = low_load(d, size, half);
  load["position"] = vec(from, half, 0);
  const auto angle = [=](double at) { return swing * (std::cos(rate * at) - 1); };
  set_led_scene(t, d, {{}, angle, {0, 1, 0}}, plate(4), load, 10);
  const std::string turned = "(" + exact(swing) + "*(cos(" + exact(rate) + "*t) - 1))", c = "cos" + turned,
                    s = "sin" + turned;
  const std::string outwards = "load.position.x*" + c + " - load.position.z*" + s + " - " + exact(from),
                    aside = "load.position.x*" + s + " + load.position.z*" + c;
  for (const std::string& q : {outwards, aside})
    expect_range(t, "largest(" + q + ")", 0, 1e-2 * size, "it stays where it is, but for how it leans");
}

/// The seat of a swing: a plate that keys lead on an arc, its face towards the middle of the arc.
void driven_swing_3d(Dice& d, Trial& t) {
  const double size = d.between(0.05, 0.2), half = size * d.between(0.3, 0.6), arm = d.between(1, 4),
               rate = d.spread(0.5, 5);
  // It tilts by 0.4 at most; the pull along the seat is at most 0.3 g beside, the one towards it 0.5 g.
  const double most = std::min({0.2, 0.3 * kPull / (rate * rate * arm), std::sqrt(0.5 * kPull / arm) / rate});
  const double swing = d.sign() * most * d.between(0.1, 1);
  json::object floor = plate(1), load = low_load(d, size, half);
  floor["position"] = vec(0, -arm - 0.1, 0), load["position"] = vec(0, half - arm, 0);
  const auto angle = [=](double at) { return swing * (std::cos(rate * at) - 1); };
  set_led_scene(t, d, {{}, angle, {0, 0, 1}}, floor, load, 5);
  const std::string turned = "(" + exact(swing) + "*(cos(" + exact(rate) + "*t) - 1))", c = "cos" + turned,
                    s = "sin" + turned;
  expect_range(t, "largest(load.position.x*" + c + " + load.position.y*" + s + ")", 0, 1e-2 * size,
               "it stays where it is, but for how it leans");
  expect_range(t, "largest(load.position.z)", 0, 2e-3 * size, "nor does it go aside");
}

}  // namespace truestep::campaign
