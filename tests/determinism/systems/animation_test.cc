// Animation gives the same bits on any number of threads, without scratch memory, and from a snapshot.
#include "engine/scene/gallery.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

constexpr const char* kReaching = R"scene({"time": {"dt": 0.01}, "systems": [
    {"type": "skeleton", "id": "s", "joints": [{"id": "a"}, {"id": "b", "parent": "a", "offset": [0.5, 0, 0], "cone": 1},
      {"id": "c", "parent": "b", "offset": [0.5, 0, 0], "end": [0.4, 0, 0]}],
     "goals": [{"joint": "c", "target": ["0.6 + 0.3*sin(t)", "0.5*cos(2*t)", "0.3"]}],
     "skin": {"tubes": [{"from": "a", "to": "c", "rings": 100, "around": 50}], "method": "linear"}},
    {"type": "particles", "id": "rain", "radius": 0.02,
     "emitters": [{"position": [0.3, 1.5, 0], "direction": [0, -1, 0], "rate": 200, "speed": 1, "cone": 0.3, "lifetime": 1}]}],
  "couplings": [{"type": "contact", "id": "c", "a": "rain", "b": "s"}]})scene";

constexpr const char* kStretching = R"scene({"time": {"dt": 0.01}, "systems": [
    {"type": "keyframes", "id": "k", "frame_rate": 24, "controls": [{"name": "a", "value": "sin(5*t)"}],
     "shapes": [{"id": "ball", "radius": 0.4, "position": ["0.1*a"], "scale": ["1", "1 + 0.3*a"]}]},
    {"type": "blend_shapes", "id": "f", "ball": {"rings": 40, "around": 40}, "position": ["3"],
     "targets": [{"name": "wide", "weight": "sin(t)", "offset": ["x"]}]},
    {"type": "particles", "id": "rain", "radius": 0.02,
     "emitters": [{"position": [0, 1.5, 0], "direction": [0, -1, 0], "rate": 200, "speed": 1, "cone": 0.3, "lifetime": 1}]}],
  "couplings": [{"type": "contact", "id": "c", "a": "rain", "b": "k"}]})scene";

class AnimationDeterminism : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, AnimationDeterminism, ::testing::Values(kReaching, kStretching));

TEST_P(AnimationDeterminism, ThreadsAndDroppedScratchChangeNothing) {
  SceneRun serial(GetParam(), 0), four(GetParam(), 4), dropped(GetParam(), 2);
  for (int i = 0; i < 100; ++i) {
    for (SceneRun* run : {&serial, &four, &dropped}) run->session.step(1);
    dropped.session.drop_workspace();
    ASSERT_EQ(serial.session.hash(), four.session.hash()) << "step " << i;
    ASSERT_EQ(serial.session.hash(), dropped.session.hash()) << "step " << i;
  }
  EXPECT_GT(std::abs(serial.observe("c.impulse.y")), 0) << "there is something to meet";
}

TEST_P(AnimationDeterminism, ASnapshotContinues) {
  SceneRun a(GetParam()), b(GetParam(), 4);
  a.session.step(60);
  b.session.restore(WorldState::deserialize(a.session.state().serialize()));
  for (int i = 0; i < 60; ++i) {
    a.session.step(1);
    b.session.step(1);
    ASSERT_EQ(a.session.hash(), b.session.hash()) << "step " << i;
  }
}

TEST(AnimationDeterminism, SetControlsAreOfTheState) {
  SceneRun a(kStretching), b(kStretching), other(kStretching);
  for (SceneRun* run : {&a, &b, &other}) run->session.step(10);
  for (SceneRun* run : {&a, &b}) {
    WorldState s = run->session.state();
    run->world->apply(s, {.kind = CommandKind::set_parameter, .system = "k", .value = 0.5, .name = "a"});
    run->session.restore(s);
  }
  for (SceneRun* run : {&a, &b, &other}) run->session.step(10);
  EXPECT_EQ(a.session.hash(), b.session.hash());
  EXPECT_NE(a.session.hash(), other.session.hash());
}

}  // namespace
}  // namespace truestep
