// States with pushes on rows that there are not. (What several pushes do is in tests/scenes/chains.)
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "tests/support/runs/world_run.h"

namespace truestep {
namespace {

struct Pushed : testing_rig::WorldRun {
  explicit Pushed(const std::string& system)
      : WorldRun(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [)" + system + "]}") {}
  void push(int64_t row, const Vec3& force, double duration) {
    Command c;
    c.kind = CommandKind::push, c.index = row, c.vector = force, c.duration = duration;
    apply(c);
  }
};

struct Case {
  std::string system;
  int64_t row;  // its last mass or link
};

const std::string kOscillator = R"({"type": "oscillator", "id": "o", "mass": 2, "stiffness": 0})";
const std::string kPendulum =
    R"({"type": "pendulum", "id": "p", "links": 2, "angle": 0.5, "length": 1, "mass": 2})";
const std::string kRod = R"({"type": "articulation", "id": "a", "links": [{"joint": "hinge",
    "axis": [0, 0, 1], "mass": 3, "center": [0.5, 0, 0], "inertia": [0.01, 0.25, 0.25]}]})";
const Case kCases[] = {{kOscillator, 0}, {kPendulum, 2}, {kRod, 0}};

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
