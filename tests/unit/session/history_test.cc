// The snapshots of a session: within their bound in bytes, as frequent as their cost allows, and exact.
#include "engine/session/snapshot/history.h"

#include <gtest/gtest.h>

namespace truestep {
namespace {

WorldState state_of(uint64_t step, size_t rows) {
  WorldState state;
  state.step = step;
  state.systems.resize(1);
  state.systems[0].add({"position", "m", Scalar::f64, 3, Role::position}, rows);
  for (double& x : state.systems[0].f64(0)) x = static_cast<double>(step);
  return state;
}

// Steps 1 ... n of a run whose every step takes `seconds`.
void run(History& history, uint64_t n, size_t rows, double seconds) {
  for (uint64_t step = 1; step <= n; ++step) {
    if (history.due(step)) history.offer(state_of(step, rows), seconds);
  }
}

// Largest distance between neighbours, and from the last to `end`.
uint64_t largest_gap(const History& history, uint64_t end) {
  uint64_t last = 0, gap = 0;
  for (const uint64_t step : history.steps()) {
    gap = std::max(gap, step - last);
    last = step;
  }
  return std::max(gap, end - last);
}

TEST(History, SnapshotsAreAsFrequentAsAStepIsDear) {
  constexpr size_t kRows = 4096;  // 98 kB: some 30 microseconds
  History dear(64 << 20), cheap(64 << 20), free(64 << 20);
  run(dear, 4096, kRows, 1e-1);
  run(cheap, 4096, kRows, 3e-5);
  run(free, 4096, kRows, 1e-9);
  EXPECT_EQ(dear.steps().size(), 4096u / 16);
  // 30 us in 256 steps of 30 us: 0.4 %; in 128 it would be more than half a percent.
  EXPECT_EQ(cheap.steps().size(), 4096u / 256);
  // However cheap a step is, a seek repeats at most a thousand of them.
  EXPECT_EQ(free.steps().size(), 4096u / 1024);
}

TEST(History, OneInterruptedStepDoesNotMakeSnapshotsFrequent) {
  History history(64 << 20);
  run(history, 1024, 4096, 3e-5);
  const size_t before = history.steps().size();
  history.offer(state_of(1280, 4096), 10.0);
  EXPECT_EQ(history.steps().size(), before + 1);
  EXPECT_FALSE(history.due(1280 + 16));
  EXPECT_FALSE(history.due(1280 + 64));
}

TEST(History, StaysWithinItsBoundAndReachesTheWholePast) {
  constexpr size_t kRows = 1000, kBytes = 24000, kBound = 20 * kBytes;
  History history(kBound);
  for (uint64_t step = 1; step <= 20000; ++step) {
    if (history.due(step)) history.offer(state_of(step, kRows), 1.0);
    ASSERT_LE(history.memory_bytes(), kBound);
  }
  EXPECT_GE(history.steps().size(), 10u);
  EXPECT_LE(largest_gap(history, 20000), 2048u);  // 20000 / 10 snapshots, rounded up to a power of two
  for (uint64_t step : {1ull, 5000ull, 12345ull, 20000ull}) {
    const WorldState* found = history.at_or_before(step);
    if (!found) continue;
    EXPECT_LE(found->step, step);
    EXPECT_EQ(*found, state_of(found->step, kRows)) << "memory used before holds something of the past";
  }
  EXPECT_EQ(history.at_or_before(1), nullptr);
}

TEST(History, GrowingStatesStayWithinTheBound) {
  constexpr size_t kBound = 600000;
  History history(kBound);
  for (uint64_t step = 1; step <= 20000; ++step) {
    if (history.due(step)) history.offer(state_of(step, step), 1.0);
    ASSERT_LE(history.memory_bytes(), kBound) << "step " << step;
  }
  ASSERT_FALSE(history.steps().empty());
  for (const uint64_t step : history.steps()) EXPECT_EQ(*history.at_or_before(step), state_of(step, step));
}

TEST(History, MemoryOfForgottenSnapshotsIsUsedAgain) {
  History history(64 << 20);
  run(history, 1600, 1000, 1.0);
  const size_t full = history.memory_bytes();
  const auto steps = history.steps();
  history.truncate(800);
  EXPECT_EQ(history.steps().back(), 800u);
  EXPECT_EQ(history.memory_bytes(), full);
  run(history, 1600, 1000, 1.0);
  EXPECT_EQ(history.memory_bytes(), full);
  EXPECT_EQ(history.steps(), steps);
  for (const uint64_t step : steps) EXPECT_EQ(*history.at_or_before(step), state_of(step, 1000));
  history.clear();
  EXPECT_EQ(history.memory_bytes(), 0u);
}

}  // namespace
}  // namespace truestep
