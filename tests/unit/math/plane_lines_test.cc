// Level lines and streamlines of values on a plane lattice.
#include <gtest/gtest.h>

#include "engine/math/iso_lines.h"
#include "engine/math/streamline.h"

namespace truestep {
namespace {

TEST(IsoLines, OfADistanceIsACircle) {
  constexpr size_t n = 41;
  std::vector<float> values;
  for (size_t j = 0; j < n; ++j) {
    for (size_t i = 0; i < n; ++i) values.push_back(static_cast<float>(std::hypot(i - 20.0, j - 20.0)));
  }
  std::vector<IsoSegment> lines;
  append_iso_lines(values, n, n, 12, lines);
  double length = 0;
  for (const auto& [a, b] : lines) {
    length += std::hypot(a[0] - b[0], a[1] - b[1]);
    // The distance is curved between nodes by at most 1 / (8 r).
    EXPECT_NEAR(std::hypot(a[0] - 20, a[1] - 20), 12, 1.0 / (8 * 12) + 1e-6);
  }
  EXPECT_NEAR(length, 2 * 3.141592653589793 * 12, 0.2);
  lines.clear();
  append_iso_lines(values, n, n, 60, lines);  // control: beyond all values
  EXPECT_TRUE(lines.empty());
}

TEST(IsoLines, SaddlesAreDecidedByTheirMiddle) {
  const auto ends = [](float corner) {
    std::vector<IsoSegment> lines;
    // Low, high, low (high for the control) around one cell; the level lies between.
    append_iso_lines(std::vector<float>{0, 1, 1, corner}, 2, 2, 0.6, lines);
    return lines;
  };
  ASSERT_EQ(ends(0).size(), 2u);
  // The middle, 0.5, is low: the high corners at (1, 0) and (0, 1) are cut off one by one.
  for (const auto& [a, b] : ends(0)) EXPECT_NEAR(a[0] - a[1], b[0] - b[1], 1e-6);
  EXPECT_EQ(ends(1).size(), 1u);
}

TEST(Streamline, OfARotationComesBack) {
  constexpr size_t n = 21;
  std::vector<float> u, v;
  for (size_t j = 0; j < n; ++j) {
    for (size_t i = 0; i < n; ++i) {
      u.push_back(10 - static_cast<float>(j));
      v.push_back(static_cast<float>(i) - 10);
    }
  }
  const PlaneField field{u, v, n, n};
  const auto line = streamline(field, 16, 10, 0.25, 500);
  ASSERT_EQ(line.size(), 500u);
  // Bilinear interpolation of a linear field is exact; the step's error is of fourth order.
  for (const auto& p : line) EXPECT_NEAR(std::hypot(p[0] - 10, p[1] - 10), 6, 1e-4);
  const std::vector<float> ones(n * n, 1), zeros(n * n);
  const auto out = streamline(PlaneField{ones, zeros, n, n}, 10, 10, 0.25, 500);
  EXPECT_LE(out.size(), 42u);  // a straight one ends at the edge
}

}  // namespace
}  // namespace truestep
