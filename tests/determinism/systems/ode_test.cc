// Ode systems give the same bits beside another state and through a journal. (On any number of threads, from
// snapshots and without scratch memory: tests/scenes/determinism.)
#include "tests/support/runs/ode_run.h"

#include "engine/session/session.h"

namespace truestep::test {
namespace {

const std::string kBall = R"s("states": {"h": 1, "v": 0, "w": [1, 2, 3, 4]},
  "equations": {"h": "v", "v": "-9.81", "w[i]": "sin(sum(j != i, w[j]))"
}, "integrator": "dopri5",
  "events": [{"when": "h", "direction": "falling", "set": {"v": "-0.9 * v"}}])s";

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
