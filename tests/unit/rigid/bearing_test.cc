#include "engine/kernels/rigid/bearing.h"

#include <gtest/gtest.h>

#include <vector>

namespace truestep {
namespace {

std::vector<BearingPoint> square() {
  return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
}

void expect_balance(const std::vector<BearingPoint>& points, double load, double mx, double my) {
  double force = 0, x = 0, y = 0;
  for (const BearingPoint& p : points) {
    EXPECT_GE(p.force, 0);
    force += p.cosine * p.force, x += p.cosine * p.force * p.x, y += p.cosine * p.force * p.y;
  }
  EXPECT_NEAR(force, load, 1e-6 * load);
  EXPECT_NEAR(x, mx, 1e-6 * load);
  EXPECT_NEAR(y, my, 1e-6 * load);
}

TEST(Bearing, ALoadInTheMiddleIsSharedAlike) {
  auto points = square();
  share_load(points, 8, 0, 0);
  for (const BearingPoint& p : points) EXPECT_NEAR(p.force, 2, 1e-7);
}

TEST(Bearing, ForcesBalanceALoadBesideTheMiddle) {
  auto points = square();
  points[2].cosine = 0.8;
  share_load(points, 10, 3, -2);
  expect_balance(points, 10, 3, -2);
}

TEST(Bearing, NoPointPulls) {
  // Near a corner: the opposite corner must be released.
  auto points = square();
  share_load(points, 1, 0.8, 0.7);
  expect_balance(points, 1, 0.8, 0.7);
  EXPECT_EQ(points[0].force, 0);
}

TEST(Bearing, PointsInALineAndASinglePoint) {
  std::vector<BearingPoint> line{{-1, 0}, {0, 0}, {1, 0}};
  share_load(line, 3, 1, 0);
  expect_balance(line, 3, 1, 0);
  std::vector<BearingPoint> one{{0, 0, 0.5}};
  share_load(one, 3, 0, 0);
  expect_balance(one, 3, 0, 0);
}

TEST(Bearing, WhatTopplesHangsOnItsEdge) {
  // The control: a load outside cannot be balanced, but still no point pulls.
  auto points = square();
  share_load(points, 1, 3, 0);
  double x = 0;
  for (const BearingPoint& p : points) {
    EXPECT_GE(p.force, 0);
    x += p.force * p.x;
  }
  EXPECT_NE(x, 3);
  EXPECT_GT(x, 0);
}

// Under the tip of a capsule whose centre is above it but for rounding. As a fraction of that lever any
// moment is enormous, and must not become a force: it turns the body.
TEST(Bearing, ATipBearsItsLoadAndNoMoment) {
  for (const double lever : {1e-18, 1e-9, 1e-3}) {
    std::vector<BearingPoint> tip{{lever, -lever}};
    share_load(tip, 3, 1, 2);
    EXPECT_NEAR(tip[0].force, 3, 1e-6) << lever;
  }
}

}  // namespace
}  // namespace truestep
