// Several pushes at once on different masses of a chain, and states with pushes on rows that there are not.
// (What several pushes on one row do is in tests/scenes/chains.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "tests/support/runs/world_run.h"

namespace truestep {
namespace {

constexpr double kPushStep = 0.01;

struct Pushed : testing_rig::WorldRun {
  explicit Pushed(const std::string& system)
      : WorldRun(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [)" + system + "]}") {}
  void push(int64_t row, const Vec3& force, double duration, std::optional<Vec3> at = std::nullopt) {
    Command c;
    c.kind = CommandKind::push, c.index = row, c.vector = force, c.duration = duration, c.at = at;
    apply(c);
  }
  double rate(size_t k) const { return value("velocity", k); }
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

// On different masses of a chain that hangs straight: the rates are the sum of those by each alone, but for
// the turning within a step (angles of 1e-4, squared).
TEST(SeveralPushes, ActWhereEachOfThemIs) {
  const std::string chain = R"({"type": "pendulum", "id": "p", "links": 3, "angle": 0, "mass": 1})";
  Pushed both(chain), one(chain), other(chain);
  both.push(1, {1, 0, 0}, kPushStep), both.push(3, {2, 0, 0}, kPushStep);
  one.push(1, {1, 0, 0}, kPushStep), other.push(3, {2, 0, 0}, kPushStep);
  for (Pushed* p : {&both, &one, &other}) p->steps(1);
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(both.rate(k), one.rate(k) + other.rate(k), 1e-7) << k;
  EXPECT_GT(std::abs(one.rate(0)), 1e-3);
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
