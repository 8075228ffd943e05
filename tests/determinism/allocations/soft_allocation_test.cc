// Steps of position-based cloth and blocks allocate in the first step only.
#include <gtest/gtest.h>

#include "engine/systems/xpbd/xpbd.h"
#include "tests/determinism/allocations/allocation_count.h"

namespace truestep {
namespace {

TEST(Allocation, PositionBasedStepsAllocateNothingAfterTheFirst) {
  for (const xpbd::Precision precision : {xpbd::Precision::f64, xpbd::Precision::f32}) {
    xpbd::XpbdDef d;
    d.cloth_grid.emplace();
    d.flexural_rigidity = 1e-4, d.internal_damping = 1e-2, d.iterations = 2, d.precision = precision;
    d.colliders.push_back(PlaneColliderDef{{}, {0, -0.05, 0}});
    d.self_collision = true;
    test::CountedSteps run(xpbd::build_xpbd(&d, {}), 1.0 / 60);
    run.steps(1);
    EXPECT_EQ(run.steps(19), 0u);
  }
}

TEST(Allocation, ClothThatTearsAllocatesNothingAfterTheFirstStep) {
  for (const xpbd::Precision precision : {xpbd::Precision::f64, xpbd::Precision::f32}) {
    xpbd::XpbdDef d;
    d.cloth_grid.emplace();
    d.flexural_rigidity = 1e-4, d.internal_damping = 1e-2, d.iterations = 2, d.precision = precision;
    d.stiffness = 10, d.pinned = {"edge_v0"}, d.tear = xpbd::TearDef{.strain = 0.1};
    test::CountedSteps run(xpbd::build_xpbd(&d, {}), 1.0 / 60);
    const size_t points = run.state().rows(0);
    run.steps(1);
    EXPECT_EQ(run.steps(39), 0u);
    EXPECT_GT(run.state().rows(0), points) << "control: it has torn";
  }
}

TEST(Allocation, SoftBlocksAllocateNothingAfterTheFirstStep) {
  for (const bool matched : {true, false}) {
    xpbd::XpbdDef d;
    d.block.emplace(), d.copies.resize(2), d.copies[1].position = {3, 0, 0};
    d.iterations = 2;
    if (matched) {
      d.matching = xpbd::MatchDef{.frequency = 3, .linear = 0.5};
    } else {
      d.youngs_modulus = 1e4;
    }
    test::CountedSteps run(xpbd::build_xpbd(&d, {}), 1.0 / 60);
    run.steps(1);
    EXPECT_EQ(run.steps(9), 0u);
  }
}

}  // namespace
}  // namespace truestep
