// Wide bands in tiles: solutions against known ones, and refusal of singular matrices.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/math/solvers/tile_band_lu.h"

namespace truestep {
namespace {

// Convection faster than diffusion: not diagonally dominant.
double element(size_t i, size_t j) {
  const double d = static_cast<double>(i) - static_cast<double>(j);
  return i == j ? 3
                : std::sin(7.0 * static_cast<double>(i) + 3 * d) / (1 + 0.05 * d * d) +
                      (d > 0 ? 0.8 : -0.8) / (d * d);
}

TEST(TileBandLu, SolvesBandsOfAnyWidthWithTheSameBitsForAnyThreads) {
  for (const auto& [n, diagonals] :
       {std::pair<size_t, size_t>{5, 2}, {32, 31}, {100, 1}, {333, 40}, {500, 64}}) {
    std::vector<double> x(n), b(n), bits;
    for (size_t i = 0; i < n; ++i) x[i] = std::cos(static_cast<double>(i));
    for (const int threads : {1, 3}) {
      TileBandLu lu;
      lu.resize(n, diagonals);
      for (size_t i = 0; i < n; ++i) {
        b[i] = 0;
        for (size_t j = i > diagonals ? i - diagonals : 0; j < std::min(n, i + diagonals + 1); ++j)
          lu.at(i, j) = element(i, j), b[i] += element(i, j) * x[j];
      }
      const ThreadArena arena(threads);
      ASSERT_TRUE(lu.factor(arena));
      lu.solve(b.data());
      // Pivots stay within a tile: growth may cost a few digits.
      for (size_t i = 0; i < n; ++i) ASSERT_NEAR(b[i], x[i], 1e-8) << n << ' ' << diagonals << ' ' << i;
      if (threads == 1) bits = b;
      EXPECT_EQ(b, bits);
    }
  }
}

TEST(TileBandLu, RowsAreExchangedWithinATile) {
  TileBandLu lu;
  lu.resize(2, 1);
  lu.at(0, 1) = 2, lu.at(1, 0) = 4;
  ASSERT_TRUE(lu.factor(ThreadArena(1)));
  double b[] = {2, 12};
  lu.solve(b);
  EXPECT_EQ(b[0], 3);
  EXPECT_EQ(b[1], 1);
  lu.resize(2, 1);
  lu.at(0, 0) = lu.at(0, 1) = lu.at(1, 0) = lu.at(1, 1) = 1;
  EXPECT_FALSE(lu.factor(ThreadArena(1))) << "control: a singular matrix";
}

}  // namespace
}  // namespace truestep
