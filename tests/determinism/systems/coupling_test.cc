// The bits of coupled systems do not depend on threads, on scratch memory, or on where a snapshot is resumed.
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

constexpr const char* kJoined = R"({"time": {"dt": 0.004, "substeps": 2}, "systems": [
    {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 30, "ny": 30}, "pinned": ["corners"]},
    {"type": "particles", "id": "dust", "positions": [[0.5, 0.4, 0.5], [1, -0.5, 1]],
     "emitters": [{"position": [0.5, 0.5, 0.5], "rate": 400, "speed": 1, "lifetime": 0.2}]}],
  "couplings": [
    {"type": "attachment", "id": "spring", "a": "cloth", "b": "dust", "damping": 0.1, "stiffness": 20,
     "a_points": [300, 40], "b_points": [0, 1]},
    {"type": "attachment", "id": "link", "a": "dust", "b": "cloth", "link": "rigid", "a_points": [1], "b_points": [17]}]})";

constexpr const char* kRain = R"({"time": {"dt": 0.004, "substeps": 2}, "systems": [
    {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 16, "ny": 16}, "pinned": ["corners"], "stiffness": 300},
    {"type": "particles", "id": "dust", "radius": 0.01, "mass": 0.002,
     "fill": [{"count": 200, "arrangement": "random", "center": [0.5, 0.3, 0.5], "half_extents": [0.4, 0.25, 0.4]}],
     "emitters": [{"position": [0.5, 0.5, 0.5], "rate": 500, "speed": 1, "cone": 1, "lifetime": 0.2}]}],
  "couplings": [
    {"type": "contact", "id": "catch", "a": "cloth", "b": "dust"},
    {"type": "contact", "id": "heap", "a": "dust", "b": "dust", "restitution": 0.2}]})";

class CoupledDeterminism : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, CoupledDeterminism, ::testing::Values(kJoined, kRain));

TEST_P(CoupledDeterminism, ThreadsAndDroppedScratchChangeNothing) {
  SceneRun serial(GetParam(), 0), one(GetParam(), 1), eight(GetParam(), 8), dropped(GetParam(), 2);
  for (int i = 0; i < 60; ++i) {
    for (SceneRun* run : {&serial, &one, &eight, &dropped}) run->session.step(1);
    dropped.session.drop_workspace();
    ASSERT_EQ(serial.session.hash(), one.session.hash()) << "step " << i;
    ASSERT_EQ(serial.session.hash(), eight.session.hash()) << "step " << i;
    ASSERT_EQ(serial.session.hash(), dropped.session.hash()) << "step " << i;
  }
}

TEST_P(CoupledDeterminism, SnapshotContinuesTheTrajectoryAndItsSums) {
  SceneRun a(GetParam()), b(GetParam(), 4);
  a.session.step(60);
  b.session.restore(WorldState::deserialize(a.session.state().serialize()));
  for (int i = 0; i < 60; ++i) {
    a.session.step(1);
    b.session.step(1);
    ASSERT_EQ(a.session.hash(), b.session.hash()) << "step " << i;
  }
  // The control: the states of the couplings matter.
  WorldState altered = a.session.state();
  ASSERT_FALSE(altered.couplings.empty());
  altered.couplings[0].f64(0)[0] += 1;
  EXPECT_NE(altered.hash(), a.session.hash());
  // A snapshot without them belongs to another scene.
  altered.couplings.clear();
  EXPECT_THROW(b.session.restore(altered), Error);
}

TEST_P(CoupledDeterminism, SeekingBackRepeatsTheRun) {
  SceneRun run(GetParam());
  run.session.step(60);
  const uint64_t hash = run.session.hash();
  run.session.step(20);
  run.session.seek(60);
  EXPECT_EQ(run.session.hash(), hash);
}

}  // namespace
}  // namespace truestep
