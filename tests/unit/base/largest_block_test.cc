// What loops over fixed blocks find together does not depend on the number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/largest_block.h"

namespace truestep::test {
namespace {

TEST(Parallel, TheLargestBlockIsThatOfAllThreads) {
  std::vector<double> x(10000);
  for (size_t i = 0; i < x.size(); ++i) x[i] = std::sin(double(i * i % 1013));
  for (const int threads : {1, 2, 5}) {
    const ThreadArena arena(threads);
    const auto largest = [&] {
      return largest_block(arena, x.size(), 64, [&](size_t begin, size_t end) {
        double most = 0;
        for (size_t i = begin; i < end && most == most; ++i) most = x[i] <= most ? most : x[i];
        return most;
      });
    };
    x[7654] = 2, x[3] = -5;
    EXPECT_EQ(largest(), 2);
    // One value that is no number decides, wherever it is; all below 0 leave 0.
    for (const size_t at : {0, 5000, 9999}) {
      const double kept = x[at];
      x[at] = NAN;
      EXPECT_TRUE(std::isnan(largest())) << at;
      x[at] = kept;
    }
    EXPECT_EQ(largest_block(arena, 100, 10, [](size_t, size_t) { return -1.0; }), 0);
  }
}

}  // namespace
}  // namespace truestep::test
