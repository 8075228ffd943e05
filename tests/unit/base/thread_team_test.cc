// Helper threads: every block is processed exactly once, whoever does it.
#include "engine/base/thread_team.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace truestep {
namespace {

TEST(ThreadTeam, DoesEveryBlockOnce) {
  for (const int threads : {1, 2, 8}) {
    const ThreadArena arena(threads);
    ThreadTeam team;
    for (int step = 0; step < 20; ++step) {
      const auto gathering = team.gather(arena);
      for (const size_t n : {0u, 1u, 7u, 8u, 9u, 1000u}) {
        std::vector<int> done(n);
        team.for_blocks(n, 8, [&](size_t begin, size_t end) {
          ASSERT_LE(end - begin, 8u);
          for (size_t i = begin; i < end; ++i) ++done[i];
        });
        EXPECT_EQ(done, std::vector<int>(n, 1)) << threads << " threads, " << n;
      }
    }
  }
}

TEST(ThreadTeam, RunsInTheCallerWhenNobodyIsGathered) {
  ThreadTeam team;
  size_t blocks = 0, elements = 0;  // not atomic: no other thread may touch them
  team.for_blocks(100, 8, [&](size_t begin, size_t end) { ++blocks, elements += end - begin; });
  EXPECT_EQ(blocks, 13u);
  EXPECT_EQ(elements, 100u);
}

TEST(ThreadTeam, LoopsSeeWhatTheLoopBeforeThemWrote) {
  const ThreadArena arena(2);
  ThreadTeam team;
  const auto gathering = team.gather(arena);
  // Every element comes from another block of the previous loop.
  std::vector<int> before(512), after(512);
  for (int loop = 0; loop < 2000; ++loop) {
    team.for_blocks(before.size(), 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) after[i] = before[(i + 100) % 512] + 1;
    });
    before.swap(after);
  }
  EXPECT_EQ(before, std::vector<int>(512, 2000));
}

}  // namespace
}  // namespace truestep
