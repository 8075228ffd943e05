// Finite element bodies give the same bits on any number of threads, with and without a workspace, and from a
// copy of a state.
#include <gtest/gtest.h>

#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

FemDef beam(Motion motion, Cell cell) {
  FemDef d;
  d.block = SoftBlockShape{.size = {3, 1, 1}, .cells_x = 12, .cells_y = 4, .cells_z = 4};
  d.element = cell, d.motion = motion, d.youngs_modulus = 2e5;
  d.pinned = {"x0"};
  d.loads = {{"x1", {}, {}, {}, {}, 500.0}};
  return d;
}

TEST(FemDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Motion motion : {Motion::dynamic, Motion::quasi_static}) {
    for (const Cell cell : {Cell::tet4, Cell::hex8}) {
      FemRun one(beam(motion, cell), 1.0 / 60, {0, -9.81, 0}, 1),
          four(beam(motion, cell), 1.0 / 60, {0, -9.81, 0}, 4);
      one.step(5), four.step(5);
      EXPECT_EQ(one.state.hash(), four.state.hash());
      FemRun other(beam(motion, cell), 1.0 / 60, {0, -9.8, 0}, 1);
      other.step(5);
      EXPECT_NE(one.state.hash(), other.state.hash());
    }
  }
}

TEST(FemDeterminism, AStateIsAllThatAStepNeeds) {
  for (const Motion motion : {Motion::dynamic, Motion::quasi_static}) {
    FemRun run(beam(motion, Cell::hex8), 1.0 / 60, {0, -9.81, 0}),
        copy(beam(motion, Cell::hex8), 1.0 / 60, {0, -9.81, 0});
    run.step(3);
    copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
    for (int k = 0; k < 3; ++k) {
      run.workspace.clear();
      run.step(), copy.step();
    }
    EXPECT_EQ(run.state.hash(), copy.state.hash());
  }
}

// Bodies that pile up and touch each other through a barrier.
TEST(FemDeterminism, BarriersKeepNothingOutsideTheState) {
  FemDef d;
  d.block = SoftBlockShape{{-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}, 2, 2, 2};
  d.element = Cell::tet4, d.youngs_modulus = 3e4, d.friction = 0.4, d.contact = Meeting::barrier;
  d.copies = {{{0, 0.15, 0}, {1, 0, 0}, {0, -1, 0}, 0.2}, {{0.05, 0.45, 0.02}, {0, 1, 1}, {0, -2, 0}, 0.7}};
  d.colliders.push_back(PlaneColliderDef{});
  FemRun one(d, 1.0 / 60, {0, -9.81, 0}, 1), four(d, 1.0 / 60, {0, -9.81, 0}, 4),
      copy(d, 1.0 / 60, {0, -9.81, 0});
  one.step(10), four.step(10);
  ASSERT_GT(one.observe("contact.pairs"), 0);
  EXPECT_EQ(one.state.hash(), four.state.hash());
  copy.state = State::deserialize(one.state.serialize()), copy.steps = one.steps;
  for (int k = 0; k < 5; ++k) {
    one.workspace.clear();
    one.step(), copy.step();
  }
  EXPECT_EQ(one.state.hash(), copy.state.hash());
  one.step();
  EXPECT_NE(one.state.hash(), copy.state.hash());
}

}  // namespace
}  // namespace truestep::fem
