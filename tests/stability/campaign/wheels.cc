// Rolling: disks, balls, cylinders and capsules with spin and slip on level ground. Coulomb friction brings
// the contact point to rest: v' = v - u c / (1 + c) after |u| c / ((1 + c) mu g), with the slip u = v + w r
// and c = I / (m r^2).
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kG = 9.81;

struct Wheel {
  double radius, friction, speed, spin, duration, dt;
  double slip() const { return speed + spin * radius; }
  double slip_time(double c) const { return std::abs(slip()) * c / (1 + c) / (friction * kG); }
};

Wheel draw(Dice& d) {
  Wheel w{.radius = d.between(0.1, 1), .friction = d.between(0.1, 1)};
  w.speed = d.chance(0.3) ? 0 : d.sign() * d.between(1, 10);
  const double how = d.unit();
  w.spin = how < 0.4   ? -w.speed / w.radius           // rolls
           : how < 0.7 ? 0                             // slides
                       : d.sign() * d.spread(3, 100);  // spins
  if (w.speed == 0 && w.spin == 0) w.spin = d.sign() * 100;
  w.dt = usual_dt(d);
  return w;
}

/// The run ends in the middle of the slip, or a while after it.
void choose_duration(Dice& d, Wheel& w, double c) {
  const double slips = w.slip_time(c);
  const double end = slips > 0.3 && d.chance(0.5) ? 0.5 * slips : std::min(1.2 * slips + 0.5, 5.0);
  w.duration = w.dt * std::ceil(end / w.dt);
}

void expect_rolling(Trial& t, const Wheel& w, double c, double height) {
  const double slips = w.slip_time(c), u = w.slip();
  const double most = u * c / (1 + c);
  const double taken = w.duration < slips ? std::copysign(w.friction * kG * w.duration, u) : most;
  // The friction impulse of one step more or less, and three per cent of friction's effect.
  const double tolerance =
      0.03 * std::abs(taken) + w.friction * kG * w.dt * (taken != 0) + 0.005 * std::abs(w.speed) + 1e-3;
  probe(t, "wheel", 1, {"position", "velocity"});
  expect_near(t, "wheel.velocity.x", w.speed - taken, tolerance, "Coulomb's friction until it rolls");
  expect_range(t, "max(wheel.position.y)", 0, height * 1.01 + 1e-3, "level ground does not throw");
  expect_range(t, "min(wheel.position.y)", height * 0.985 - 1e-3, height * 2, "nor does it give way");
  t.rules.gain = 0.01;
}

}  // namespace

void wheel_2d(Dice& d, Trial& t) {
  Wheel w = draw(d);
  choose_duration(d, w, 0.5);
  const json::array bodies{{{"motion", "fixed"},
                            {"position", vec(0, -1)},
                            {"friction", w.friction},
                            {"shapes", json::array{{{"type", "box"}, {"half_extents", vec(500, 1)}}}}},
                           {{"position", vec(0, w.radius)},
                            {"velocity", vec(w.speed, 0)},
                            {"angular_velocity", w.spin},
                            {"friction", w.friction},
                            {"density", d.spread(1, 5000)},
                            {"shapes", json::array{{{"type", "circle"}, {"radius", w.radius}}}}}};
  set_scene(t, w.dt, w.duration, {0, -kG, 0}, {{{"type", "rigid2d"}, {"bodies", bodies}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
  if (d.chance(0.2)) system_of(t)["substeps"] = d.of({8, 16});
  expect_rolling(t, w, 0.5, w.radius);
}

void wheel_3d(Dice& d, Trial& t) {
  Wheel w = draw(d);
  const double half = w.radius * d.between(0.2, 1);
  const std::string kind = d.of({"sphere", "cylinder", "cylinder", "capsule"});
  double c = kind == "sphere" ? 0.4 : 0.5;
  if (kind == "capsule") {
    // About its axis: a cylinder of height 2 h and a ball of radius r.
    const double tube = 2 * half, ball = 4.0 / 3 * w.radius;
    c = (0.5 * tube + 0.4 * ball) / (tube + ball);
  }
  choose_duration(d, w, c);
  json::object body{{"type", kind},
                    {"radius", w.radius},
                    {"position", vec(0, w.radius)},
                    {"velocity", vec(w.speed, 0)},
                    {"angular_velocity", vec(0, 0, w.spin)},
                    {"density", d.spread(10, 5000)}};
  if (kind != "sphere") {
    // From along y to along z.
    body["half_length"] = half, body["axis"] = vec(1, 0, 0), body["angle"] = std::numbers::pi / 2;
  }
  json::object floor{{"type", "plane"}, {"motion", "fixed"}};
  if (d.chance(0.5)) {
    floor = {
        {"type", "box"}, {"motion", "fixed"}, {"position", vec(0, -1)}, {"half_extents", vec(200, 1, 20)}};
  }
  set_scene(t, w.dt, w.duration, {0, -kG, 0},
            {{{"type", "rigid3d"}, {"friction", w.friction}, {"bodies", json::array{floor, body}}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
  expect_rolling(t, w, c, w.radius);
}

/// Spinning upright about the vertical, on a face or a pole.
void spin_3d(Dice& d, Trial& t) {
  const double r = d.between(0.1, 1), half = r * d.between(0.1, 1), dt = usual_dt(d);
  const std::string kind = d.of({"sphere", "cylinder", "cylinder", "box"});
  json::object body{{"type", kind}, {"angular_velocity", vec(0, d.sign() * d.spread(1, 100), 0)}};
  const double height = kind == "sphere" ? r : half;
  body["position"] = vec(0, height);
  if (kind == "box") {
    body["half_extents"] = vec(r, half, r * d.between(0.8, 1));
  } else {
    body["radius"] = r;
    if (kind == "cylinder") body["half_length"] = half;
  }
  set_scene(t, dt, 2, {0, -kG, 0},
            {{{"type", "rigid3d"},
              {"friction", d.between(0, 1)},
              {"bodies", json::array{{{"type", "plane"}, {"motion", "fixed"}}, body}}}});
  probe(t, "top", 1, {"position"});
  expect_range(t, "max(top.position.y)", 0, height * 1.01 + 1e-3, "level ground does not throw");
  expect_range(t, "min(top.position.y)", height * 0.985 - 1e-3, height * 2, "nor does it give way");
  for (const char* along : {"top.position.x", "top.position.z"})
    expect_near(t, along, 0, 0.05 * r, "friction about the vertical gives it nowhere to go");
}

}  // namespace truestep::campaign
