// Streamlines that keep apart.
#include <gtest/gtest.h>

#include "engine/math/even_streamlines.h"

namespace truestep {
namespace {

// An eddy, squeezed so that circles crowd together on one side.
struct Eddy {
  static constexpr size_t kSide = 40;
  std::vector<float> u, v;
  Eddy() {
    for (size_t j = 0; j < kSide; ++j) {
      for (size_t i = 0; i < kSide; ++i) {
        const float x = float(i) - 26, y = float(j) - 20;
        u.push_back(-y), v.push_back(x * (x > 0 ? 9 : 1));
      }
    }
  }
  PlaneField field() const { return {u, v, kSide, kSide}; }
};

double closest(const std::vector<std::vector<std::array<double, 2>>>& lines) {
  double least = 1e300;
  for (size_t a = 0; a < lines.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      // Both halves of a line start from one seed.
      if (lines[a].front() == lines[b].front()) continue;
      for (const auto& p : lines[a]) {
        for (const auto& q : lines[b]) least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1]));
      }
    }
  }
  return least;
}

TEST(EvenStreamlines, KeepApartWhereTheFlowCrowds) {
  const Eddy eddy;
  const auto lines = even_streamlines(eddy.field(), 60);
  // The viewer draws the same lines (web/test/view.test.mjs).
  size_t points = 0;
  for (const auto& line : lines) points += line.size();
  EXPECT_EQ(lines.size(), 19u);
  EXPECT_EQ(points, 1056u);
  // A quarter of the seeds' spacing of 39 / sqrt(60).
  EXPECT_GE(closest(lines), 0.25 * 39 / std::sqrt(60.0));
  // Control: lines from the same seeds without looking at each other.
  std::vector<std::vector<std::array<double, 2>>> alone;
  for (size_t k = 0; k < 8; ++k)
    alone.push_back(streamline(eddy.field(), 2.4 + 4.9 * double(k), 20, 0.5, 160));
  EXPECT_LT(closest(alone), 1);
}

// Cells have centres half a spacing inside their box, which the lines cross all the same.
TEST(EvenStreamlines, RunThroughTheMarginOfCells) {
  const std::vector<float> u(64, 0), v(64, 1);
  const auto reach = [&](double margin) {
    double low = 1e300, high = -1e300;
    for (const auto& line : even_streamlines({u, v, 8, 8, margin}, 5)) {
      for (const auto& p : line) low = std::min(low, p[1]), high = std::max(high, p[1]);
    }
    return std::array{low, high};
  };
  const auto [low, high] = reach(0.5);
  // Up to the last step of half a spacing.
  EXPECT_LT(low, 0);
  EXPECT_GE(low, -0.5);
  EXPECT_GT(high, 7);
  EXPECT_LE(high, 7.5);
  const auto [first, last] = reach(0);
  EXPECT_GE(first, 0) << "control: nodes end at the outermost ones";
  EXPECT_LE(last, 7);
}

}  // namespace
}  // namespace truestep
