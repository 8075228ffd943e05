// Bodies in water give the same bits on any number of threads, without scratch memory, and from a snapshot.
#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

using namespace testing_coupled;

std::string afloat(const std::string& solver) {
  Bath bath;
  bath.size = {0.4, 0.5, 0.4}, bath.depth = 0.2;
  bath.body =
      R"("type": "box", "half_extents": [0.06, 0.05, 0.04], "position": [0.2, 0.26, 0.2], "angular_velocity": [1, 2, 3], "velocity": [0.5, -1, 0], "density": 400)";
  bath.water = R"(, "solver": ")" + solver + "\"";
  return bath.scene();
}

class ImmersionDeterminism : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solvers, ImmersionDeterminism, ::testing::Values("dfsph", "wcsph", "pbf"));

TEST_P(ImmersionDeterminism, ThreadsAndDroppedScratchChangeNothing) {
  const std::string scene = afloat(GetParam());
  SceneRun one(scene, 1), three(scene, 3), dropped(scene, 2);
  for (int i = 0; i < 12; ++i) {
    for (SceneRun* run : {&one, &three, &dropped}) run->session.step(1);
    dropped.session.drop_workspace();
    ASSERT_EQ(one.session.hash(), three.session.hash()) << "step " << i;
    ASSERT_EQ(one.session.hash(), dropped.session.hash()) << "step " << i;
  }
  EXPECT_NE(body_velocity(one).y, -1 - 9.81 * 12 / 60) << "control: it has met the water";
}

TEST_P(ImmersionDeterminism, ASnapshotContinuesTheTrajectory) {
  const std::string scene = afloat(GetParam());
  SceneRun a(scene), b(scene, 2);
  a.session.step(10);
  b.session.restore(WorldState::deserialize(a.session.state().serialize()));
  for (int i = 0; i < 5; ++i) {
    a.session.step(1), b.session.step(1);
    ASSERT_EQ(a.session.hash(), b.session.hash()) << "step " << i;
  }
  // The control: the coupling's own state, the other impulses on the body, matters.
  WorldState s = WorldState::deserialize(a.session.state().serialize());
  s.couplings[0] = b.world->initial_state().couplings[0];
  b.session.restore(s);
  a.session.step(1), b.session.step(1);
  EXPECT_NE(a.session.hash(), b.session.hash());
}

}  // namespace
}  // namespace truestep
