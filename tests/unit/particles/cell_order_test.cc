#include "engine/neighbours/cell_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/random.h"
#include "engine/neighbours/cell_lattice.h"

namespace truestep {
namespace {

/// Cells of n points, every eleventh of which has none.
std::vector<uint32_t> random_cells(size_t n, size_t cells, uint64_t seed) {
  std::vector<uint32_t> out(n);
  for (size_t i = 0; i < n; ++i) {
    const double u = uniform4(seed, 0, i)[0];
    out[i] = i % 11 == 10 ? CellOrder::kNone : static_cast<uint32_t>(u * u * static_cast<double>(cells));
  }
  return out;
}

void expect_sorted(const CellOrder& order, const std::vector<uint32_t>& cell, size_t cells) {
  std::vector<uint32_t> expected;
  for (uint32_t i = 0; i < cell.size(); ++i) {
    if (cell[i] != CellOrder::kNone) expected.push_back(i);
  }
  std::stable_sort(expected.begin(), expected.end(),
                   [&](uint32_t a, uint32_t b) { return cell[a] < cell[b]; });
  ASSERT_EQ(order.size(), expected.size());
  size_t wrong = 0;
  for (size_t k = 0; k < expected.size(); ++k) wrong += order.point(k) != expected[k];
  EXPECT_EQ(wrong, 0u);
  size_t slot = 0;
  for (size_t c = 0; c <= cells; ++c) {
    while (slot < expected.size() && cell[expected[slot]] < c) ++slot;
    wrong += order.start(c) != slot;
  }
  EXPECT_EQ(wrong, 0u);
}

// One object sorts sets of all sizes one after the other, by one thread and by several.
TEST(CellOrder, IsByCellThenByIndexForAnyNumberOfThreads) {
  for (const int threads : {1, 3}) {
    const ThreadArena arena(threads);
    CellOrder order;
    uint64_t seed = 1;
    for (const size_t n : {size_t{20'000}, size_t{0}, size_t{1}, size_t{5'000}, size_t{70'001}}) {
      for (const size_t cells : {size_t{1}, size_t{7}, size_t{129}, size_t{100'000}}) {
        const std::vector<uint32_t> cell = random_cells(n, cells, ++seed);
        order.sort(
            n, cells, [&](size_t i) { return cell[i]; }, arena);
        SCOPED_TRACE(::testing::Message()
                     << threads << " threads, " << n << " points, " << cells << " cells");
        expect_sorted(order, cell, cells);
      }
    }
  }
}

template <int D>
void check_pairs(const bool* wraps) {
  constexpr double kReach = 0.3;
  constexpr size_t kPoints = 200;
  const double low[3] = {-0.2, 0.1, 0.4}, high[3] = {0.8, 1.3, 1.5};
  CellLattice<D> cells;
  cells.divide(low, high, kReach);
  for (int a = 0; a < D; ++a) cells.wraps[a] = wraps[a];
  std::vector<std::array<double, 3>> x(kPoints);
  std::vector<size_t> cell(kPoints);
  const auto index = [&](size_t i, int* c) {
    for (int a = 0; a < D; ++a) c[a] = cells.along(x[i][static_cast<size_t>(a)], a);
  };
  for (size_t i = 0; i < kPoints; ++i) {
    const auto u = uniform4(5, 0, i);
    int c[3] = {};
    for (size_t a = 0; a < 3; ++a) x[i][a] = a < D ? low[a] + u[a] * (high[a] - low[a]) : 0;
    index(i, c), cell[i] = cells.of(c);
  }
  CellOrder order;
  order.sort(
      kPoints, cells.cells(), [&](size_t i) { return cell[i]; }, ThreadArena{});
  size_t wrong = 0, across = 0;
  for (size_t i = 0; i < kPoints; ++i) {
    std::vector<int> found(kPoints, 0);
    int c[3] = {};
    index(i, c);
    cells.around(c, [&](size_t first, size_t end, const double* shift) {
      for (size_t k = order.start(first); k < order.start(end); ++k) {
        double square = 0;
        for (size_t a = 0; a < D; ++a) square += std::pow(x[order.point(k)][a] + shift[a] - x[i][a], 2);
        if (square < kReach * kReach) {
          ++found[order.point(k)];
          across += shift[0] != 0 || shift[1] != 0 || shift[2] != 0;
        }
      }
    });
    for (size_t j = 0; j < kPoints; ++j) {
      double square = 0;
      for (size_t a = 0; a < D; ++a) {
        double way = std::abs(x[i][a] - x[j][a]);
        if (wraps[a]) way = std::min(way, high[a] - low[a] - way);
        square += way * way;
      }
      // Points at the very reach may be near or not, by rounding.
      if (std::abs(std::sqrt(square) - kReach) < 1e-12) continue;
      wrong += found[j] != (square < kReach * kReach ? 1 : 0);
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(across > 0, wraps[0] || wraps[1] || (D == 3 && wraps[2])) << "control: images are found";
}

TEST(CellLattice, RunsHoldEveryPairWithinReachOnce) {
  for (int bits = 0; bits < 8; ++bits) {
    const bool wraps[3] = {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
    check_pairs<2>(wraps), check_pairs<3>(wraps);
  }
}

TEST(CellLattice, TakesWhatIsOutsideToTheNearestCell) {
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  CellLattice<3> cells;
  cells.divide(low, high, 0.1);
  EXPECT_EQ(cells.count[0], 10);
  EXPECT_EQ(cells.along(0.55, 0), 5);
  EXPECT_EQ(cells.along(-1e300, 0), 0);
  EXPECT_EQ(cells.along(1e300, 0), 9);
  EXPECT_EQ(cells.along(HUGE_VAL, 0), 9);
  EXPECT_EQ(cells.along(NAN, 0), 0);
  cells.divide(low, high, 5);
  EXPECT_EQ(cells.cells(), 1u) << "a box narrower than a cell is one";
}

}  // namespace
}  // namespace truestep
