// Which liquids are given energy from outside, so that it is no fault of theirs.
#include <gtest/gtest.h>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

std::string liquid(const std::string& members) {
  return R"({"systems": [{"type": "sph", "id": "w", "low": [0, 0, 0], "high": [1, 1, 1], "spacing": 0.05, )" +
         members + "}]}";
}

// What lies still in a box that moves is given energy without a source in the liquid.
TEST(SphEnergy, WallsThatMoveMakeItOpen) {
  const auto energy = [](const std::string& more) {
    SceneRun run(
        liquid(R"("bodies": [{"center": [0.5, 0.2, 0.5], "half_extents": [0.5, 0.2, 0.5]}])" + more));
    Workspace workspace;
    return run.world->system(0)
        .energy(run.session.state().systems[0], 0, workspace, ThreadArena(1))
        ->exchange;
  };
  EXPECT_EQ(energy(""), Energy::Exchange::closed);
  const std::string paddle = R"(, "colliders": [{"type": "sphere", "center": [0.5, 0.8, 0.5], "radius": 0.1)";
  EXPECT_EQ(energy(paddle + "}]"), Energy::Exchange::closed) << "at rest";
  EXPECT_EQ(energy(paddle + R"(, "motion": {"velocity": [1, 0, 0]}}])"), Energy::Exchange::open);
  EXPECT_EQ(energy(R"(, "vorticity": 1)"), Energy::Exchange::open);
  EXPECT_EQ(energy(R"(, "emitters": [{"position": [0.5, 0.8, 0.5], "speed": 1, "radius": 0.1}])"),
            Energy::Exchange::open);
}

}  // namespace
}  // namespace truestep
