// Ode systems give the same bits on any number of threads, through snapshots, with a discarded workspace, and
// through a journal; and no step allocates.
#include "tests/support/runs/ode_run.h"

#include "engine/session/session.h"

namespace truestep::test {
namespace {

const std::string kFlow =
    R"s("states": {"c": [0.1, 0.2]}, "parameters": {"w": 2}, "equations": {"c[i]": "cos(w * t + i)"
},
  "events": [{"name": "flip", "every": 0.17, "set": {"w": "-w"}}, {"when": "c[0] - 0.15", "set": {"c[1]": "c[1] + 0.01"}}],
  "tracers": {"velocity": {"x": "sin(z + c[0]) + cos(y)", "y": "sin(x) + cos(z)", "z": "sin(y) + cos(x + c[1])"},
              "count": 3000, "box_min": [0, 0, 0], "box_max": [6, 6, 6]})s";
const std::string kBall = R"s("states": {"h": 1, "v": 0, "w": [1, 2, 3, 4]},
  "equations": {"h": "v", "v": "-9.81", "w[i]": "sin(sum(j != i, w[j]))"
}, "integrator": "dopri5",
  "events": [{"when": "h", "direction": "falling", "set": {"v": "-0.9 * v"}}])s";

// Methods with a memory, and an event that clears it.
std::string remembering(const std::string& method) {
  return R"s("states": {"x": 1}, "velocities": {"x": 0.5}, "parameters": {"k": 40}, "second": {"x": "-k * x - 0.2 * x'"
},
  "events": [{"every": 0.43, "set": {"k": "k + 1"}}], "integrator": ")s" +
         method + "\"";
}

std::vector<uint64_t> hashes(OdeRun& run, int steps) {
  std::vector<uint64_t> out;
  for (int k = 0; k < steps; ++k) out.push_back(run.steps(1).state.hash());
  return out;
}

TEST(OdeDeterminism, AnyNumberOfThreads) {
  OdeRun serial(kFlow, 0.05, 0);
  const auto expected = hashes(serial, 30);
  for (const int threads : {1, 2, 8}) {
    OdeRun run(kFlow, 0.05, threads);
    EXPECT_EQ(hashes(run, 30), expected) << threads;
  }
  // Control: half the step gives another run.
  OdeRun other(kFlow, 0.025, 0);
  EXPECT_NE(hashes(other, 30), expected);
}

TEST(OdeDeterminism, RestoredSnapshotsAndDroppedWorkspacesContinueTheSameTrajectory) {
  for (const std::string& system :
       {kFlow, kBall, remembering("bdf2"), remembering("generalized_alpha"), remembering("radau5")}) {
    OdeRun whole(system, 0.05);
    const auto expected = hashes(whole, 40);
    OdeRun run(system, 0.05);
    run.steps(17);
    const auto bytes = run.state.serialize();
    OdeRun elsewhere(system, 0.05);
    elsewhere.steps(3);
    elsewhere.state = WorldState::deserialize(bytes);
    for (int k = 17; k < 40; ++k) {
      elsewhere.workspace.clear();
      EXPECT_EQ(elsewhere.steps(1).state.hash(), expected[static_cast<size_t>(k)]) << k;
    }
  }
}

TEST(OdeDeterminism, TwoStatesOfOneSystemDoNotNoticeEachOther) {
  OdeRun alone(kBall, 0.05), first(kBall, 0.05);
  alone.steps(20);
  WorldState second = first.state;
  Workspace workspace;
  const ThreadArena arena(1);
  for (int k = 0; k < 20; ++k) {
    first.world.step(second, workspace, arena, {});
    if (k % 3 == 0) second.systems[0].f64(0)[0] += 0.1;
    first.world.step(first.state, workspace, arena, {});
  }
  EXPECT_EQ(first.state.hash(), alone.state.hash());
}

TEST(OdeDeterminism, TheJournalReplaysCommands) {
  const auto world = std::make_shared<const World>(parse_scene(
      R"s({"schema_version": "1.0", "time": {"dt": 0.02}, "systems": [{"type": "ode", "id": "s", )s" + kBall +
      "}]}"));
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session s(world, arena);
  Command c;
  c.kind = CommandKind::set_parameter;
  c.system = "s", c.name = "v", c.value = 3;
  s.step(20);
  s.command(c);
  s.step(40);
  const uint64_t end = s.hash();
  s.seek(10);
  s.seek(60);
  EXPECT_EQ(s.hash(), end);
}

}  // namespace
}  // namespace truestep::test
