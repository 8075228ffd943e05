// The death of the only particle used to remove the integrator's own scalar columns, as if they were its row.
#include <gtest/gtest.h>

#include "engine/session/world/world.h"

namespace truestep {
namespace {

TEST(LoneParticle, ItsDeathLeavesTheMethodsNumbers) {
  const World world(parse_scene(R"({"schema_version":"1.0","name":"one","time":{"dt":0.01},
    "systems":[{"type":"particles","id":"p","integrator":"verlet","mass":1,
                "emitters":[{"rate":1,"position":[0,1,0],"lifetime":0.5}]}]})"));
  WorldState s = world.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const State& p = s.systems[0];
  for (int n = 0; n < 80; ++n) world.step(s, workspace, arena, {});
  EXPECT_EQ(p.rows(p.at("position")), 0u);
  EXPECT_EQ(p.rows(p.at("integrator.left_step")), 1u);
  // Control: what belongs to the particle is gone.
  for (int n = 0; n < 100; ++n) world.step(s, workspace, arena, {});
  EXPECT_EQ(p.rows(p.at("integrator.previous_position")), p.rows(p.at("position")));
}

}  // namespace
}  // namespace truestep
