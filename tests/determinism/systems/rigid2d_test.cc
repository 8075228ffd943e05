// Rigid bodies in the plane give the same bits on any number of threads, after a restore in the middle of a
// collapse, without scratch memory, and with an unrelated sleeping body beside them.
#include <gtest/gtest.h>

#include "tests/support/world_run.h"

namespace truestep {
namespace {

std::string scene(const char* precision, const char* more = "") {
  return std::string(
             R"({"time": {"dt": 0.016666666666666666}, "systems": [{"type": "rigid2d", "id": "r", "precision": ")") +
         precision + R"(", "bodies": [
    {"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [60, 1, 0]}]},
    {"motion": "kinematic", "position": [0, 3, 0], "angular_velocity": 0.7,
     "shapes": [{"type": "box", "half_extents": [3, 0.2, 0]}]},
    {"position": [-30, 12, 0], "velocity": [60, 0, 0], "bullet": true, "shapes": [{"type": "circle", "radius": 0.6}]})" +
         more + R"(],
    "generators": [
      {"type": "wall", "nx": 16, "ny": 14, "origin": [4, 0.3, 0], "spacing": [0.82, 0.6, 0],
       "body": {"shapes": [{"type": "box", "half_extents": [0.4, 0.3, 0]}]}},
      {"type": "grid", "nx": 12, "ny": 12, "origin": [-8, 6, 0], "spacing": [0.5, 0.5, 0],
       "body": {"restitution": 0.3, "shapes": [{"type": "capsule", "from": [-0.1, 0, 0], "to": [0.1, 0, 0], "radius": 0.12}]}},
      {"type": "chain", "links": 12, "from": [-12, 8, 0], "to": [-6, 10, 0], "radius": 0.1, "held": "both"}]}]})";
}

struct Trial : testing_rig::WorldRun {
  using WorldRun::WorldRun;
  uint64_t hash() const { return state.systems[0].hash(); }
};

TEST(Rigid2dDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const char* precision : {"f32", "f64"}) {
    Trial one(scene(precision));
    one.steps(150);
    for (const int threads : {2, 8}) {
      Trial many(scene(precision), threads);
      many.steps(150);
      EXPECT_EQ(many.hash(), one.hash()) << precision << " " << threads;
    }
  }
}

TEST(Rigid2dDeterminism, GoesOnTheSameAfterARestoreInTheMiddleOfACollapse) {
  for (const char* precision : {"f32", "f64"}) {
    Trial whole(scene(precision));
    whole.steps(70);
    Trial restored(scene(precision));
    restored.state.systems[0] = State::deserialize(whole.state.systems[0].serialize());
    restored.state.step = whole.state.step;
    for (int k = 0; k < 5; ++k) {
      whole.steps(20), restored.steps(20);
      ASSERT_EQ(restored.hash(), whole.hash()) << precision << " " << k;
    }
    // The control: a restore without the contacts' impulses takes another course.
    Trial forgetful(scene(precision));
    forgetful.state.systems[0] = State::deserialize(whole.state.systems[0].serialize());
    for (float& p : forgetful.state.systems[0].span<float>(forgetful.state.systems[0].at("contact.impulse")))
      p = 0;
    whole.steps(1), forgetful.steps(1);
    EXPECT_NE(forgetful.hash(), whole.hash());
  }
}

TEST(Rigid2dDeterminism, ScratchMayBeThrownAwayBetweenAnyTwoSteps) {
  Trial kept(scene("f32")), bare(scene("f32"));
  kept.steps(120);
  for (int i = 0; i < 120; ++i) bare.workspace.clear(), bare.steps(1);
  EXPECT_EQ(bare.hash(), kept.hash());
}

TEST(Rigid2dDeterminism, ASleepingBodyElsewhereChangesNothing) {
  Trial alone(scene("f32"));
  Trial beside(scene("f32", R"(, {"position": [500, 5, 0], "asleep": true, "shapes": [{"type": "box"}]})"));
  alone.steps(150), beside.steps(150);
  const State &a = alone.state.systems[0], &b = beside.state.systems[0];
  const auto x = a.f64(a.at("position")), y = b.f64(b.at("position"));
  ASSERT_EQ(y.size(), x.size() + 3);
  for (size_t i = 0; i < 9; ++i) EXPECT_EQ(x[i], y[i]);
  for (size_t i = 9; i < x.size(); ++i) EXPECT_EQ(x[i], y[i + 3]);
}

}  // namespace
}  // namespace truestep
