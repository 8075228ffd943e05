// Disks at exactly one place used to be pushed apart along one line and remained in one another for long.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/rigid2d_run.h"

namespace truestep {
namespace {

TEST(Rigid2dSamePlace, DisksPartInAllDirectionsAboveTheFloor) {
  std::string bodies =
      R"({"motion": "fixed", "position": [0, -1, 0], "shapes": [{"type": "box", "half_extents": [100, 1, 0]}]})";
  for (int k = 0; k < 100; ++k) {
    bodies += R"(, {"position": [0, 3, 0], "shapes": [{"type": "circle", "radius": 0.2}]})";
  }
  testing::FlatTrial t(R"("bodies": [)" + bodies + "]");
  t.steps(300);
  double lowest = 3, highest = 0;
  for (size_t i = 1; i <= 100; ++i) {
    lowest = std::min(lowest, t.position(i).y), highest = std::max(highest, t.position(i).y);
  }
  EXPECT_GT(lowest, 0.19);
  EXPECT_LT(highest, 5);  // a heap; the line was 40 m long
  EXPECT_LT(t.observed("penetration.max"), 0.01);
}

}  // namespace
}  // namespace truestep
