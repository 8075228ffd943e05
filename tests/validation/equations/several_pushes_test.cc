// Several pushes at once on systems of joints and on the oscillator: their forces add up, each ends at its
// own time, and what these systems do not have, a drag or a pin, is refused by name.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

constexpr double kPushStep = 0.01;

struct Pushed {
  explicit Pushed(const std::string& system)
      : world(parse_scene(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [)" + system + "]}")),
        state(world.initial_state()) {}
  void push(int64_t row, const Vec3& force, double duration, std::optional<Vec3> at = std::nullopt) {
    Command c;
    c.kind = CommandKind::push, c.index = row, c.vector = force, c.duration = duration, c.at = at;
    world.system(0).apply(state.systems[0], c);
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k) world.step(state, workspace, arena, {});
  }
  double rate(size_t k) const { return state.systems[0].f64(state.systems[0].at("velocity"))[k]; }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

struct Case {
  std::string system;
  int64_t row;  // its last mass or link
  size_t rate;  // of that one
};

const std::string kOscillator = R"({"type": "oscillator", "id": "o", "mass": 2, "stiffness": 0})";
const std::string kPendulum =
    R"({"type": "pendulum", "id": "p", "links": 2, "angle": 0.5, "length": 1, "mass": 2})";
const std::string kRod = R"({"type": "articulation", "id": "a", "links": [{"joint": "hinge",
    "axis": [0, 0, 1], "mass": 3, "center": [0.5, 0, 0], "inertia": [0.01, 0.25, 0.25]}]})";
const Case kCases[] = {{kOscillator, 0, 0}, {kPendulum, 2, 1}, {kRod, 0, 0}};

// Forces are summed in another order: a few roundings.
TEST(SeveralPushes, AddUpToTheSumOfTheirForces) {
  const Vec3 first{1, 2, 0}, second{2, -1, 0};
  for (const Case& c : kCases) {
    Pushed both(c.system), sum(c.system), last(c.system);
    both.push(c.row, first, 1), both.push(c.row, second, 1);
    sum.push(c.row, first + second, 1);
    last.push(c.row, second, 1);
    for (Pushed* p : {&both, &sum, &last}) p->steps(10);
    EXPECT_NEAR(both.rate(c.rate), sum.rate(c.rate), 1e-12) << c.system;
    EXPECT_GT(std::abs(last.rate(c.rate) - sum.rate(c.rate)), 1e-3) << "the control: " << c.system;
  }
}

// Without a spring, momentum is the sum of the forces times their durations.
TEST(SeveralPushes, EndEachAtItsTime) {
  Pushed o(kOscillator);
  o.push(0, {3, 0, 0}, 5 * kPushStep), o.push(0, {1, 0, 0}, 10 * kPushStep), o.push(0, {7, 0, 0}, 0);
  o.steps(1);
  EXPECT_NEAR(2 * o.rate(0), (3 + 1 + 7) * kPushStep, 1e-14);
  o.steps(4);
  EXPECT_NEAR(2 * o.rate(0), (3 * 5 + 1 * 5 + 7) * kPushStep, 1e-14);
  o.steps(10);
  EXPECT_NEAR(2 * o.rate(0), (3 * 5 + 1 * 10 + 7) * kPushStep, 1e-14);
}

// On different masses of a chain that hangs straight, and at different points of a rod: the rates are the sum
// of those by each alone, but for the turning within a step (angles of 1e-4, squared).
TEST(SeveralPushes, ActWhereEachOfThemIs) {
  const std::string chain = R"({"type": "pendulum", "id": "p", "links": 3, "angle": 0, "mass": 1})";
  Pushed both(chain), one(chain), other(chain);
  both.push(1, {1, 0, 0}, kPushStep), both.push(3, {2, 0, 0}, kPushStep);
  one.push(1, {1, 0, 0}, kPushStep), other.push(3, {2, 0, 0}, kPushStep);
  for (Pushed* p : {&both, &one, &other}) p->steps(1);
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(both.rate(k), one.rate(k) + other.rate(k), 1e-7) << k;
  EXPECT_GT(std::abs(one.rate(0)), 1e-3);

  Pushed rod(kRod);
  rod.push(0, {0, 2, 0}, kPushStep, Vec3{0.25, 0, 0}), rod.push(0, {0, 4, 0}, kPushStep, Vec3{1, 0, 0});
  rod.steps(1);
  EXPECT_NEAR(rod.rate(0), kPushStep * (2 * 0.25 + 4 * 1) / (0.25 + 3 * 0.25), 1e-6);
}

TEST(SeveralPushes, WhatASystemDoesNotHaveIsRefusedByName) {
  for (const Case& c : kCases) {
    for (const CommandKind kind : {CommandKind::drag, CommandKind::release, CommandKind::pin}) {
      Pushed p(c.system);
      Command command;
      command.kind = kind, command.index = c.row;
      try {
        p.world.system(0).apply(p.state.systems[0], command);
        ADD_FAILURE() << c.system;
      } catch (const Error& e) {
        EXPECT_EQ(e.issues().at(0).pointer, "/type") << c.system;
        EXPECT_EQ(e.issues().at(0).allowed, "push, impulse, set_parameter") << c.system;
      }
    }
  }
}

// From outside: a push on a row that does not exist, or without a force, must not reach a step.
TEST(SeveralPushes, AStateWithAPushOnNoRowIsRefused) {
  for (const Case& c : kCases) {
    Pushed p(c.system);
    p.push(c.row, {1, 0, 0}, 1);
    EXPECT_NO_THROW(p.world.require_state(p.state)) << "the control: " << c.system;
    WorldState elsewhere = p.state, short_of_force = p.state;
    State& s = elsewhere.systems[0];
    s.span<uint32_t>(s.find("push.row") ? s.at("push.row") : s.at("push.link"))[0] = 1000;
    EXPECT_THROW(p.world.require_state(elsewhere), Error) << c.system;
    State& t = short_of_force.systems[0];
    t.resize(t.at("push.force"), 0);
    EXPECT_THROW(p.world.require_state(short_of_force), Error) << c.system;
  }
}

}  // namespace
}  // namespace truestep
