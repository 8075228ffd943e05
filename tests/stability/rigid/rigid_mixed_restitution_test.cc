// A ball that bounces falls on a block that does not: the floor's response to the impact used to act again as
// the warm-start impulse of the next substep and threw the block at the ball, which bounced: 3 kJ became 65
// kJ. (Loads that are not in balance are in tests/scenes/rigid.)
#include <gtest/gtest.h>

#include "tests/support/mixed_restitution.h"

namespace truestep {
namespace {

using testing::mixed_scene;
using testing::MixedScene;
using testing::run_mixed;
using testing::Space;

/// Impacts remove energy or conserve it. The energy stored in the springs of contacts may return, which no
/// observable counts: N^2 / 2 k, with up to 300 times more mass on top less than some percent of m g times
/// the height of the whole.
constexpr double kSprings = 0.02;

/// Number of scenes, among `count` of 4 s each, that ever have more energy than at the start.
int scenes_that_gain(MixedScene scene, uint64_t count) {
  int gain = 0;
  for (scene.seed = 0; scene.seed < count; ++scene.seed) {
    const auto e = run_mixed(mixed_scene(scene), 4);
    if (e.most > kSprings) {
      ++gain;
      ADD_FAILURE() << (scene.space == Space::plane ? "plane " : "space ") << scene.precision << " seed "
                    << scene.seed << ": " << e.start << " J grow by " << 100 * e.most << " %";
    }
  }
  return gain;
}

TEST(RigidMixedRestitution, NoSceneInThePlaneGainsEnergy) {
  EXPECT_EQ(scenes_that_gain({Space::plane, ""}, 140), 0);
  EXPECT_EQ(scenes_that_gain({Space::plane, "f64"}, 40), 0);
}

TEST(RigidMixedRestitution, NoSceneInSpaceGainsEnergy) {
  EXPECT_EQ(scenes_that_gain({Space::space, ""}, 140), 0);
  EXPECT_EQ(scenes_that_gain({Space::space, "f64"}, 40), 0);
}

}  // namespace
}  // namespace truestep
