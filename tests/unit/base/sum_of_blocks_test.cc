// Sums over blocks have the same bits whichever thread is done first.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "engine/base/parallel.h"

namespace truestep {
namespace {

TEST(SumOfBlocks, IsTheSameWhicheverBlockEndsFirst) {
  // In another order these round to another sum.
  const auto block = [](size_t begin) {
    return std::ldexp(1 + 0.3 * std::sin(double(begin)), int(begin) % 40);
  };
  double expected = 0, backwards = 0;
  for (size_t b = 0; b < 16; ++b) expected += block(10 * b), backwards += block(10 * (15 - b));
  ASSERT_NE(expected, backwards) << "control";
  for (const int threads : {1, 2, 4}) {
    const ThreadArena arena(threads);
    for (const size_t slow : {0, 50, 80}) {
      const auto body = [&](size_t begin, size_t) {
        if (begin == slow) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return block(begin);
      };
      EXPECT_EQ(arena.sum_blocks(160, 10, body), expected) << threads << " threads, slow block " << slow;
    }
  }
}

}  // namespace
}  // namespace truestep
