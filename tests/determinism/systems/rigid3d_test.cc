// The bits of a collapsing heap do not depend on threads, on scratch memory, or on where it is restored.
#include <gtest/gtest.h>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::RigidRun;

Rigid3dDef heap() {
  Rigid3dDef d;
  d.bodies.push_back(testing::ground());
  const auto copies = [](Vec3 spacing) {
    CopiesDef c;
    c.count = {5, 4, 5}, c.spacing = spacing, c.jitter = 0.1, c.turn = CopiesDef::Turn::random;
    return c;
  };
  BoxBodyDef b = testing::box({0.25, 0.2, 0.15}, {0, 0.6, 0});
  b.copies = copies({0.8, 1.4, 0.8});
  CapsuleBodyDef c;
  c.radius = 0.15, c.half_length = 0.2, c.position = {0.1, 1.3, 0.1}, c.copies = copies({0.8, 1.4, 0.8});
  HullBodyDef h;
  h.points = {{0.2, 0, 0}, {-0.2, 0, 0.1}, {0, 0.3, 0}, {0, 0, -0.2}, {0.1, -0.2, 0.2}};
  h.position = {3, 1, 0}, h.copies = copies({0.7, 0.7, 0.7});
  CompoundBodyDef l;
  BoxPartDef part;
  part.half_extents = {0.3, 0.1, 0.1};
  l.parts.push_back(part);
  part.position = {0.2, 0.3, 0}, part.half_extents = {0.1, 0.2, 0.1};
  l.parts.push_back(part);
  l.position = {-3, 1, 0}, l.copies = copies({0.9, 0.9, 0.9});
  // A chain of balls that hangs over the heap.
  SphereBodyDef bead = testing::ball(0.1, {0, 4, 0});
  bead.copies = CopiesDef{};
  bead.copies->count = {10, 1, 1}, bead.copies->spacing = {0.25, 1, 1};
  d.bodies.push_back(bead);
  BallJointDef j;
  j.a = 1, j.b = 2, j.repeat = 9;
  d.joints.push_back(j);
  d.bodies.push_back(b), d.bodies.push_back(c), d.bodies.push_back(h), d.bodies.push_back(l);
  return d;
}

class Rigid3dDeterminism : public ::testing::TestWithParam<Rigid3dDef::Precision> {
 protected:
  static Rigid3dDef scene() {
    Rigid3dDef d = heap();
    d.precision = GetParam();
    return d;
  }
};

INSTANTIATE_TEST_SUITE_P(Precisions, Rigid3dDeterminism,
                         ::testing::Values(Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64));

TEST_P(Rigid3dDeterminism, ThreadsChangeNothing) {
  RigidRun one(scene()), two(scene(), 1.0 / 60, 2), eight(scene(), 1.0 / 60, 8);
  for (RigidRun* run : {&one, &two, &eight}) run->run(90);
  EXPECT_EQ(one.state, two.state);
  EXPECT_EQ(one.state, eight.state);
}

TEST_P(Rigid3dDeterminism, RestoredInTheMiddleOfACollapseItGoesOnTheSame) {
  RigidRun run(scene());
  run.run(40);
  RigidRun other(scene());
  other.state = State::deserialize(run.state.serialize());
  other.steps = run.steps;
  run.run(60), other.run(60);
  EXPECT_EQ(run.state, other.state);
  // The control: without the contacts' impulses they would.
  RigidRun cold(scene());
  cold.run(40);
  for (double& l : cold.state.f64(rigid3d::columns::contact_impulse)) l = 0;
  cold.run(60);
  EXPECT_FALSE(run.state == cold.state);
}

TEST_P(Rigid3dDeterminism, ASleepingBodyElsewhereChangesNothing) {
  // Inserted right after the ground, so that every other body has another row.
  Rigid3dDef d = scene();
  d.bodies.insert(d.bodies.begin() + 1, testing::box({0.5, 0.5, 0.5}, {500, 5, 0}));
  for (auto& j : d.joints) ++std::get<BallJointDef>(j).a, ++std::get<BallJointDef>(j).b;
  RigidRun alone(d), beside(d), awake(d);
  remove_body(alone.state, 1);
  beside.state.span<uint32_t>(rigid3d::columns::asleep)[1] = 1;
  alone.run(90), beside.run(90), awake.run(90);
  ASSERT_EQ(beside.count(), alone.count() + 1);
  for (size_t i = 1; i < alone.count(); ++i) {
    ASSERT_EQ(alone.x(i), beside.x(i + 1)) << i;
    ASSERT_EQ(alone.w(i), beside.w(i + 1)) << i;
  }
  // The control: it did sleep, in mid-air.
  EXPECT_EQ(beside.x(1), (Vec3{500, 5, 0}));
  EXPECT_LT(awake.x(1).y, 4);
}

TEST_P(Rigid3dDeterminism, DroppedWorkspaceChangesNothing) {
  RigidRun kept(scene()), dropped(scene());
  for (int k = 0; k < 60; ++k) {
    kept.run(1), dropped.run(1);
    dropped.workspace.clear();
    ASSERT_EQ(kept.state, dropped.state) << "step " << k;
  }
}

}  // namespace
}  // namespace truestep
