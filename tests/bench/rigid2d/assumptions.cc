#include "tests/bench/rigid2d/assumptions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep::bench {
namespace {

using Kind = FlatBody::Kind;

const FlatBody kGround{Kind::fixed, 0, -1, 0, {{100, 1}}};

std::unique_ptr<FlatEngine> after(const MakeFlatEngine& make, const FlatScene& scene, double seconds,
                                  Sleep sleep = Sleep::never) {
  auto engine = make(scene, sleep);
  for (int k = 0; k < std::lround(seconds / kFlatDt); ++k) engine->step();
  return engine;
}

FlatScene on_ground(FlatBody body, double height) {
  body.y = height;
  return {.name = "one body", .bodies = {kGround, body}};
}

FlatScene in_free_space(std::vector<FlatBody> bodies) {
  return {.name = "free", .bodies = std::move(bodies), .gravity = 0};
}

FlatBody body(const FlatShape& shape, double x = 0, double vx = 0) {
  return {Kind::dynamic, x, 0, vx, {shape}};
}

}  // namespace

std::vector<Assumption> flat_assumptions(const MakeFlatEngine& make) {
  std::vector<Assumption> all;
  const auto height = [&](const FlatBody& b, double at, double seconds) {
    return after(make, on_ground(b, at), seconds)->look(1).pose.y;
  };
  // Engines keep boxes apart by a skin or let them sink, by a centimetre either way.
  constexpr double kSlop = 0.02;
  all.push_back({"a box has half edges", 0.3, kSlop, height(body({0.5, 0.3}), 0.3, 2)});
  FlatBody turned = body({0.5, 0.3});
  turned.angle = std::numbers::pi / 2;
  all.push_back({"angles turn counter-clockwise from x, in radians", 0.5, kSlop, height(turned, 0.5, 1)});
  all.push_back({"a disk has a radius", 0.4, kSlop, height(body({0, 0.4}), 0.4, 2)});
  FlatShape quad{0.5, 0.3};
  quad.corners = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}};
  all.push_back({"a polygon has its corners", 0.3, kSlop, height(body(quad), 0.3, 2)});
  FlatScene on_segment = on_ground(body({0.5, 0.3}), 0.3);
  on_segment.bodies[0] = {Kind::fixed, 0, 0, 0, {{100, 0}}};
  all.push_back(
      {"a segment holds from above at its height", 0.3, kSlop, after(make, on_segment, 2)->look(1).pose.y});

  const double g = 10, braking = kFlatFriction * g;
  all.push_back({"a box of 4 m/s slides v^2 / (2 mu g): friction combines to 0.6", 16 / (2 * braking),
                 0.5 * 4 * kFlatDt + 0.03,
                 after(make, on_ground(body({0.5, 0.2}, 0, 4), 0.2), 2)->look(1).pose.x});
  double highest = 0;
  auto falling = make(on_ground(body({0, 0.4}), 2), Sleep::never);
  for (int k = 0; k < 120; ++k) {
    falling->step();
    if (k > 40) highest = std::max(highest, falling->look(1).pose.y);
  }
  all.push_back({"nothing bounces: a disk that fell 1.6 m stays down", 0.4, 0.03, highest});
  const FlatScene fall{.name = "fall", .bodies = {body({0, 0.5})}};
  all.push_back({"gravity is 10 along -y", -0.5 * g, g * kFlatDt, after(make, fall, 1)->look(0).pose.y});

  // Rounding of f32 in 600 steps; a damping of 0.05 / s would take 40 %.
  constexpr double kUndamped = 2e-3;
  FlatBody free = body({0.5, 0.3}, 0, 1);
  free.spin = 2;
  const auto drifting = after(make, in_free_space({free}), 10);
  all.push_back({"velocity is not damped", 1, kUndamped, drifting->look(0).vx});
  all.push_back({"spin is not damped", 2, kUndamped, drifting->look(0).spin});

  // However elastic a hit is, momentum reveals the ratio of the masses.
  const auto mass_ratio = [&](const FlatBody& hitting, const FlatBody& hit) {
    const auto engine = after(make, in_free_space({hitting, hit}), 1.5);
    return (hitting.vx - engine->look(0).vx) / engine->look(1).vx;
  };
  all.push_back({"masses are density times area (boxes)", 0.25, 1e-3,
                 mass_ratio(body({0.5, 0.5}, 0, 2), body({0.25, 0.25}, 1))});
  const FlatBody disk = body({0, 0.4}, 0, 2);
  const double disk_mass = std::numbers::pi * 0.16, dense_mass = 8 * 0.64;
  all.push_back({"masses are density times area (a disk, a box of density 8)", dense_mass / disk_mass, 0.01,
                 mass_ratio(disk, body({0.4, 0.4, 0, 0, 8}, 1.2))});

  const FlatScene resting = on_ground(body({0.5, 0.5}), 0.5);
  all.push_back({"nothing sleeps where sleep is off", 0, 0.5, 1.0 * after(make, resting, 10)->asleep(1)});
  all.push_back(
      {"what rests sleeps where it may", 1, 0.5, 1.0 * after(make, resting, 10, Sleep::allowed)->asleep(1)});
  FlatScene sleeper = resting;
  sleeper.bodies[1].kind = Kind::sleeper;
  all.push_back({"a sleeper may sleep in any scene", 1, 0.5, 1.0 * after(make, sleeper, 10)->asleep(1)});
  FlatScene hit = in_free_space({body({0.5, 0.5}, -2, 4), body({0.5, 0.5})});
  hit.bodies[1].kind = Kind::asleep;
  all.push_back({"what is asleep at the start sleeps on", 1, 0.5, 1.0 * after(make, hit, 0.1)->asleep(1)});
  all.push_back({"and wakes when it is hit", 2, 0.04, after(make, hit, 1)->look(1).vx});

  FlatScene motor{.name = "motor", .gravity = 0};
  motor.bodies = {{Kind::fixed, 0, 0, 0, {}}, body({0.5, 0.5})};
  motor.joints = {{0, 1, 0, 0, 0, 0, 0.4, 1e8}};
  all.push_back(
      {"a motor turns counter-clockwise at its speed", 0.4, 0.004, after(make, motor, 1)->look(1).spin});
  FlatScene joined{.name = "pendulum", .collide = false};
  joined.bodies = {{Kind::fixed, 0, 0, 0, {{0, 0.4}}}, {Kind::dynamic, 0, -1, 0, {{0, 0.4}}}};
  joined.joints = {{0, 1, 0, -0.5, 0, 0.5}};
  all.push_back({"a joint holds its anchors", -1, 0.01, after(make, joined, 2)->look(1).pose.y});
  FlatScene passing = in_free_space({disk, body({0, 0.4}, 1.2)});
  passing.collide = false;
  all.push_back({"what does not collide passes", 2, 1e-4, after(make, passing, 1)->look(0).vx});
  return all;
}

}  // namespace truestep::bench
