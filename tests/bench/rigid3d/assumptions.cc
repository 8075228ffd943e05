#include "tests/bench/rigid3d/assumptions.h"

#include <cmath>
#include <numbers>

namespace truestep::bench {
namespace {

using Shape = SpaceBody::Shape;

const SpaceBody kGround{.size = {100, 100, 1}, .pose = {{0, 0, -1}, {}}, .fixed = true};
const Quat kUpright{std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // y to z

/// The engine after the given time.
std::unique_ptr<SpaceEngine> after(const MakeSpaceEngine& make, const SpaceScene& scene, double seconds,
                                   Sleep sleep = Sleep::never) {
  auto engine = make(scene, sleep);
  for (int k = 0; k < std::lround(seconds / kSpaceDt); ++k) engine->step();
  return engine;
}

SpaceScene on_ground(SpaceBody body, double height) {
  body.pose.position = {0, 0, height};
  return {.name = "one body", .bodies = {kGround, body}};
}

SpaceScene in_free_space(std::vector<SpaceBody> bodies) {
  return {.name = "free", .bodies = std::move(bodies), .gravity = {}};
}

/// A box of half edges 0.5, 0.4, 0.3 as a prism.
SpaceBody brick() {
  SpaceBody b{.shape = Shape::prism, .size = {0, 0.4, 0}};
  b.corners = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}};
  return b;
}

}  // namespace

std::vector<Assumption> space_assumptions(const MakeSpaceEngine& make) {
  std::vector<Assumption> all;
  const auto height = [&](const SpaceBody& body, double at, double seconds) {
    return after(make, on_ground(body, at), seconds)->state(1).pose.position.z;
  };
  // Engines let resting bodies sink by some millimetres.
  constexpr double kSlop = 0.015;
  all.push_back({"a capsule's axis is y: lying, it rests at the height of its radius", 0.3, kSlop,
                 height({.shape = Shape::capsule, .size = {0.3, 0.4, 0}}, 0.3, 2)});
  all.push_back({"turned upright, a capsule stands at the height of radius and half length", 0.7, kSlop,
                 height({.shape = Shape::capsule, .size = {0.3, 0.4, 0}, .pose = {{}, kUpright}}, 0.7, 0.2)});
  all.push_back({"a box has half edges", 0.3, kSlop, height({.size = {0.5, 0.4, 0.3}}, 0.3, 2)});
  all.push_back({"a turned box stands on its side", 0.4, kSlop,
                 height({.size = {0.5, 0.4, 0.3}, .pose = {{}, kUpright}}, 0.4, 1)});
  all.push_back(
      {"a ball has a radius", 0.45, kSlop, height({.shape = Shape::sphere, .size = {0.45, 0, 0}}, 0.45, 2)});
  all.push_back({"a prism has its corners", 0.3, kSlop, height(brick(), 0.3, 2)});

  SpaceBody sliding{.size = {0.5, 0.5, 0.2}};
  sliding.velocity = {4, 0, 0};
  const double braking = kSpaceFriction * 9.81;
  all.push_back({"a box of 4 m/s slides v^2 / (2 mu g): friction combines to 0.5", 16 / (2 * braking),
                 // The motion of half a step, and the effect of tipping.
                 0.5 * 4 * kSpaceDt + 0.03,
                 after(make, on_ground(sliding, 0.2), 2)->state(1).pose.position.x});

  double highest = 0;
  auto falling = make(on_ground({.shape = Shape::sphere, .size = {0.45, 0, 0}}, 2), Sleep::never);
  for (int k = 0; k < 120; ++k) {
    falling->step();
    if (k > 40) highest = std::max(highest, falling->state(1).pose.position.z);
  }
  all.push_back({"nothing bounces: a ball that fell 1.5 m stays down", 0.45, 0.03, highest});
  const SpaceScene fall{.name = "fall", .bodies = {{.shape = Shape::sphere, .size = {0.5, 0, 0}}}};
  all.push_back({"gravity is 9.81 along -z", -0.5 * 9.81, 9.81 * kSpaceDt,
                 after(make, fall, 1)->state(0).pose.position.z});

  // Rounding of f32 in 600 steps; a damping of 0.05 / s would take 40 %.
  constexpr double kUndamped = 2e-3;
  SpaceBody free{.shape = Shape::sphere, .size = {0.5, 0, 0}, .angular_velocity = {0, 0, 2}};
  free.velocity = {1, 0, 0};
  const auto drifting = after(make, in_free_space({free}), 10);
  all.push_back({"velocity is not damped", 1, kUndamped, drifting->state(0).velocity.x});
  all.push_back({"spin is not damped", 2, kUndamped, drifting->state(0).angular_velocity.z});

  // However elastic a hit is, momentum reveals the ratio of the masses.
  const auto mass_ratio = [&](const SpaceBody& hitting, const SpaceBody& hit) {
    const auto engine = after(make, in_free_space({hitting, hit}), 1);
    return (hitting.velocity.x - engine->state(0).velocity.x) / engine->state(1).velocity.x;
  };
  SpaceBody big{.size = {0.5, 0.5, 0.5}}, small{.size = {0.25, 0.25, 0.25}, .pose = {{1, 0, 0}, {}}};
  big.velocity = {2, 0, 0};
  all.push_back({"masses are density times volume (boxes)", 1.0 / 8, 1e-4, mass_ratio(big, small)});
  SpaceBody ball{.shape = Shape::sphere, .size = {0.45, 0, 0}};
  ball.velocity = {2, 0, 0};
  const SpaceBody capsule{.shape = Shape::capsule, .size = {0.3, 0.4, 0}, .pose = {{1.2, 0, 0}, {}}};
  const double ball_mass = 4.0 / 3 * std::pow(0.45, 3),
               capsule_mass = 0.3 * 0.3 * 0.8 + 4.0 / 3 * std::pow(0.3, 3);
  all.push_back({"masses are density times volume (ball, capsule)", capsule_mass / ball_mass, 1e-3,
                 mass_ratio(ball, capsule)});

  const SpaceScene resting = on_ground({}, 0.5);
  all.push_back({"nothing sleeps where sleep is off", 0, 0.5,
                 static_cast<double>(after(make, resting, 10)->asleep(1))});
  all.push_back({"what rests sleeps where it may", 1, 0.5,
                 static_cast<double>(after(make, resting, 10, Sleep::allowed)->asleep(1))});

  SpaceScene joined{.name = "pendulum", .collide = false};
  joined.bodies = {{.shape = Shape::sphere, .size = {0.4, 0, 0}, .fixed = true},
                   {.shape = Shape::sphere, .size = {0.4, 0, 0}, .pose = {{0, 0, -1}, {}}}};
  joined.joints = {{0, 1, {0, 0, -0.5}}};
  all.push_back(
      {"a ball joint holds its anchor", -1, 0.01, after(make, joined, 2)->state(1).pose.position.z});
  SpaceScene passing =
      in_free_space({ball, {.shape = Shape::sphere, .size = {0.45, 0, 0}, .pose = {{1.2, 0, 0}, {}}}});
  passing.collide = false;
  all.push_back({"what does not collide passes", 2, 1e-4, after(make, passing, 1)->state(0).velocity.x});
  return all;
}

}  // namespace truestep::bench
