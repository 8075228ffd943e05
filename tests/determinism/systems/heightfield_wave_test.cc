// Shallow water gives the same bits for any number of threads, with a workspace that is discarded, and from a
// restored snapshot; that its steps do not allocate is checked in grid_allocation_test.
#include <gtest/gtest.h>

#include "tests/support/fluids/shallow_run.h"

namespace truestep::test {
namespace {

std::unique_ptr<ShallowRun> make(size_t dimensions, int threads) {
  heightfield_wave::HeightfieldWaveDef d;
  d.cells = dimensions == 1 ? std::vector<int64_t>{5000} : std::vector<int64_t>{130, 70};
  d.bed = "0.3*x";
  d.surface = "x < 0.3 ? 0.4 : 0.1";
  d.friction = 0.01;
  d.sides.x_max = heightfield_wave::EdgeDef{heightfield_wave::EdgeDef::Kind::open};
  return std::make_unique<ShallowRun>(d, 0.01, threads);
}

TEST(HeightfieldWaveBits, DoNotDependOnHowTheRunIsMade) {
  for (const size_t dimensions : {1, 2}) {
    constexpr uint64_t kSteps = 4;
    const auto reference = make(dimensions, 1);
    std::vector<std::byte> snapshot;
    for (uint64_t n = 0; n < kSteps; ++n) {
      if (n == kSteps / 2) snapshot = reference->state.serialize();
      reference->steps(1);
    }
    const uint64_t hash = reference->state.hash();
    ASSERT_NE(hash, reference->system->initial_state().hash());
    for (const int threads : {2, 5}) {
      const auto run = make(dimensions, threads);
      run->steps(kSteps);
      EXPECT_EQ(run->state.hash(), hash) << threads << " threads";
    }
    const auto dropped = make(dimensions, 1);
    for (uint64_t n = 0; n < kSteps; ++n) dropped->workspace.clear(), dropped->steps(1);
    EXPECT_EQ(dropped->state.hash(), hash) << "workspace dropped";
    const auto restored = make(dimensions, 1);
    restored->state = State::deserialize(snapshot);
    restored->done() = kSteps / 2;
    restored->steps(kSteps - kSteps / 2);
    EXPECT_EQ(restored->state.hash(), hash) << "restored";
  }
}

}  // namespace
}  // namespace truestep::test
