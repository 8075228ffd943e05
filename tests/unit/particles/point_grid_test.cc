#include "engine/neighbours/point_grid.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "engine/base/random.h"

namespace truestep {
namespace {

std::vector<double> cloud(size_t n, double size) {
  std::vector<double> x;
  for (size_t i = 0; i < n; ++i) {
    const auto u = uniform4(1, 2, i);
    for (int k = 0; k < 3; ++k) x.push_back(size * u[k]);
  }
  return x;
}

TEST(PointGrid, FindsEveryNeighbourOnce) {
  for (const double reach : {0.01, 0.1, 0.5, 3.0}) {
    auto x = cloud(500, 1);
    x[0] = 1e6;  // an outlier makes cells large, never wrong
    PointGrid grid;
    grid.build(x, reach);
    ASSERT_EQ(grid.size(), 500u);
    for (size_t i = 0; i < 500; i += 7) {
      std::multiset<uint32_t> found, expected;
      grid.near(load3(x.data(), i), [&](size_t begin, size_t end) {
        for (size_t q = begin; q < end; ++q) {
          if (norm(grid.position(q) - load3(x.data(), i)) < reach) found.insert(grid.point(q));
        }
      });
      for (uint32_t j = 0; j < 500; ++j) {
        if (norm(load3(x.data(), j) - load3(x.data(), i)) < reach) expected.insert(j);
      }
      EXPECT_EQ(found, expected);
    }
  }
}

// As is usual in the plane, along a line and at a single place; and where the box is a whole number of cells.
TEST(PointGrid, FlatSetsHaveCells) {
  for (const int axes : {0, 1, 2, 3}) {
    std::vector<double> x;
    for (int i = 0; i < 125; ++i) {
      const int at[3] = {i % 5, i / 5 % 5, i / 25};
      for (int a = 0; a < 3; ++a) x.push_back(a < axes ? 0.5 * at[a] : 2);
    }
    PointGrid grid;
    grid.build(x, 0.5);
    ASSERT_EQ(grid.size(), 125u);
    for (size_t i = 0; i < 125; ++i) {
      size_t found = 0, expected = 0;
      const Vec3 p = load3(x.data(), i);
      grid.near(p, [&](size_t begin, size_t end) {
        for (size_t q = begin; q < end; ++q) found += norm(grid.position(q) - p) <= 0.5;
      });
      for (size_t j = 0; j < 125; ++j) expected += norm(load3(x.data(), j) - p) <= 0.5;
      ASSERT_EQ(found, expected) << axes << " axes, point " << i;
    }
  }
}

TEST(PointGrid, IsTheSameForAnyNumberOfThreads) {
  const auto x = cloud(20'000, 1);
  const ThreadArena several(3);
  PointGrid one, many;
  one.build(x, 0.02), many.build(x, 0.02, several);
  ASSERT_EQ(one.size(), many.size());
  size_t wrong = 0;
  for (size_t k = 0; k < one.size(); ++k) {
    wrong += one.point(k) != many.point(k) || !(one.position(k) == many.position(k));
  }
  EXPECT_EQ(wrong, 0u);
}

TEST(PointGrid, LeavesOutWhatIsNotFinite) {
  auto x = cloud(10, 1);
  x[4] = std::numeric_limits<double>::quiet_NaN();
  x[9] = std::numeric_limits<double>::infinity();
  PointGrid grid;
  grid.build(x, 0.1);
  EXPECT_EQ(grid.size(), 8u);
  x.clear();
  grid.build(x, 0.1);
  EXPECT_EQ(grid.size(), 0u);
}

}  // namespace
}  // namespace truestep
