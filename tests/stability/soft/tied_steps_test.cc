// Steps of points and bodies tied together are subdivided where they would gain energy. Whether a step is
// subdivided follows from the state at its start: a restored state continues with the same bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/session/world/world.h"

namespace truestep {
namespace {

/// Five kilograms on thirty grams of rope, released from the side, at 30 steps a second.
Scene swinging(const char* method) {
  return parse_scene(
      std::string(R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.03333333333333333}, "systems": [
    {"type": "mass_spring", "id": "rope", "rope": {"from": [0, 3, 0], "to": [1.5, 3, 0], "links": 5},
     "mass": 0.005, "stiffness": 160, "pinned": ["first"], "integrator": ")") +
      method + R"("},
    {"type": "rigid3d", "id": "load", "bodies": [{"type": "sphere", "radius": 0.1, "position": [1.5, 3, 0],
     "mass": 5}]}], "couplings": [{"type": "attachment", "id": "tie", "a": "rope", "b": "load",
     "a_points": [-1], "b_points": [0], "link": "spring", "stiffness": 1200}]})");
}

struct SwingRun {
  explicit SwingRun(const char* method) : world(swinging(method)), state(world.initial_state()) {}
  void steps(int n) {
    for (int k = 0; k < n; ++k) {
      world.step(state, workspace, arena, {});
      const double now = world.observe(state).find("energy.total").value();
      most = std::max(most, now);
    }
  }
  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
  double most = -1e300;
};

TEST(TiedSteps, GainNoEnergy) {
  SwingRun run("linear_implicit_euler");
  const double start = run.world.observe(run.state).find("energy.total").value();
  run.steps(150);
  // 143 J fall and swing; the first step's rounding of the rope is far below a hundredth of that.
  EXPECT_LT(run.most - start, 1.43);
}

TEST(TiedSteps, GoOnWithTheSameBitsFromARestoredState) {
  for (const int before : {60, 84, 90}) {
    SwingRun whole("linear_implicit_euler"), again("linear_implicit_euler");
    whole.steps(before);
    again.state = WorldState::deserialize(whole.state.serialize());
    whole.steps(40), again.steps(40);
    EXPECT_EQ(whole.state.hash(), again.state.hash()) << before;
  }
}

}  // namespace
}  // namespace truestep
