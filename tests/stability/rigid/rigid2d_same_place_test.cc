// Bodies at exactly one place used to be pushed apart along one line, and those inside a crowd by what a
// single sweep of pushes left for them: thirty boxes were as deep in one another after five seconds as at the
// start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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
  EXPECT_LT(t.observed("penetration"), 0.01);
}

/// Bodies of this shape at one place, and nothing else.
testing::FlatTrial crowd(const std::string& shape, int n) {
  std::string bodies;
  for (int k = 0; k < n; ++k) {
    bodies += std::string(k ? ", " : "") + R"({"position": [1, 3, 0], "shapes": [)" + shape + "]}";
  }
  return testing::FlatTrial(R"("gravity": [0, 0, 0], "bodies": [)" + bodies + "]");
}
const std::string kDisk = R"({"type": "circle", "radius": 0.2})",
                  kBox = R"({"type": "box", "half_extents": [0.2, 0.2, 0]})",
                  kTriangle =
                      R"({"type": "polygon", "points": [[-0.2, -0.2, 0], [0.2, -0.2, 0], [0, 0.2, 0]]})",
                  kCapsule = R"({"type": "capsule", "radius": 0.1, "from": [-0.2, 0, 0], "to": [0.2, 0, 0]})";

// Thirty fill a circle of 1.2 m. Capsules in parallel part across their length only, ten of them along 2 m.
// With one sweep of pushes disks are 7 cm deep after three seconds, boxes 35 cm after five.
TEST(Rigid2dSamePlace, ACrowdPartsWithinSecondsAtPushOutSpeed) {
  for (const std::string& shape : {kDisk, kBox, kTriangle, kCapsule}) {
    const size_t n = shape == kCapsule ? 10 : 30;
    testing::FlatTrial t = crowd(shape, static_cast<int>(n));
    double fastest = 0;
    const int seconds = shape == kDisk ? 3 : 5;
    for (int step = 0; step < 60 * seconds; ++step) {
      std::vector<Vec3> before;
      for (size_t i = 0; i < n; ++i) before.push_back(t.position(i));
      t.steps(1);
      for (size_t i = 0; i < n; ++i) fastest = std::max(fastest, 60 * norm(t.position(i) - before[i]));
      if (step == 0) {
        EXPECT_GT(t.observed("penetration"), 0.15) << "control: they begin in one another";
      }
    }
    // A twentieth of their thickness.
    EXPECT_LT(t.observed("penetration"), 0.02) << shape;
    EXPECT_LE(fastest, 3) << shape;
  }
}

// Two at one place part along their least overlap as before: nothing else moves them aside.
TEST(Rigid2dSamePlace, TwoCapsulesPartStraight) {
  testing::FlatTrial t(R"("gravity": [0, 0, 0], "bodies": [{"shapes": [)" + kCapsule + R"(]}, {"shapes": [)" +
                       kCapsule + "]}]");
  t.steps(120);
  EXPECT_LT(t.observed("penetration"), 1e-3);
  EXPECT_NEAR(t.position(0).x, t.position(1).x, 1e-3);
  EXPECT_NEAR(std::abs(t.position(0).y - t.position(1).y), 0.2, 1e-3);
}

}  // namespace
}  // namespace truestep
