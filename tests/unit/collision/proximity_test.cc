// Closest points of a point and a triangle and of two segments against a search over both features, and the
// first time at which moving features come near against small steps in time.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/kernels/contact/proximity.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep {
namespace {

using xpbd::testing_numbers::Numbers;

/// The least distance over points of a grid of both features.
double searched(const FeaturePoints& x, bool segments) {
  constexpr int kSteps = 60;
  double least = HUGE_VAL;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const double s = double(i) / kSteps, t = double(k) / kSteps;
      if (!segments && s + t > 1) continue;
      const Vec3 p = segments ? x[0] + (x[1] - x[0]) * s : x[0];
      const Vec3 q = segments ? x[2] + (x[3] - x[2]) * t : x[1] + (x[2] - x[1]) * s + (x[3] - x[1]) * t;
      least = std::min(least, norm(p - q));
    }
  }
  return least;
}

template <class Kind>
void check_closest() {
  Numbers r;
  for (int n = 0; n < 200; ++n) {
    const FeaturePoints x{1.5 * r.vector(), r.vector(), r.vector(), r.vector()};
    const Proximity at = Kind::closest(x);
    const double least = searched(x, Kind::kFirst == 2);
    // A grid of 60 is never nearer than the closest points, and not much farther: sides of at most 3.5 / 60.
    EXPECT_LE(at.distance, least + 1e-12);
    EXPECT_GE(at.distance, least - 0.06);
    EXPECT_NEAR(at.c[0] + at.c[1] + at.c[2] + at.c[3], 0, 1e-14);
    for (size_t i = 0; i < 4; ++i) EXPECT_GE(i < Kind::kFirst ? at.c[i] : -at.c[i], -1e-14);
  }
}

TEST(Proximity, ClosestPointsAreTheClosest) {
  check_closest<PointTriangle>();
  check_closest<SegmentSegment>();
}

TEST(Proximity, ParallelAndPointLikeSegmentsHaveADistance) {
  const FeaturePoints side{Vec3{0, 0, 0}, {1, 0, 0}, {0.25, 1, 0}, {0.75, 1, 0}};
  EXPECT_NEAR(SegmentSegment::closest(side).distance, 1, 1e-15);
  const FeaturePoints apart{Vec3{0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {4, 4, 0}};
  EXPECT_NEAR(SegmentSegment::closest(apart).distance, 5, 1e-15);
}

template <class Kind>
void check_approach() {
  constexpr double kTarget = 0.05;
  constexpr int kSteps = 1000;
  Numbers r;
  int hits = 0, misses = 0;
  for (int n = 0; n < 1000; ++n) {
    const FeaturePoints x{r.vector(), r.vector(), r.vector(), r.vector()};
    const FeaturePoints dx{r.vector(), r.vector(), r.vector(), r.vector()};
    const Proximity start = Kind::closest(x);
    if (start.distance <= kTarget) continue;
    double least = HUGE_VAL;
    for (int k = 0; k <= kSteps; ++k) {
      FeaturePoints there;
      for (size_t i = 0; i < 4; ++i) there[i] = x[i] + dx[i] * (double(k) / kSteps);
      const double d = Kind::closest(there).distance;
      least = std::min(least, d);
    }
    const auto hit = first_approach<Kind>(x, dx, kTarget, start);
    if (least < 0.8 * kTarget) {
      ASSERT_TRUE(hit) << n;
      // Before four fifths of the target, but never too late.
      EXPECT_LE(hit->at.distance, kTarget);
      EXPECT_GE(hit->at.distance, 0.8 * kTarget - 1e-12);
      ++hits;
    } else if (least > 1.01 * kTarget) {
      EXPECT_FALSE(hit) << n;
      ++misses;
    }
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(misses, 30);
}

TEST(Proximity, FirstApproachIsFoundOnStraightPaths) {
  check_approach<PointTriangle>();
  check_approach<SegmentSegment>();
}

TEST(Proximity, NoSpeedStepsOverAFeature) {
  // A point that crosses a triangle in a millionth of its path.
  const FeaturePoints x{Vec3{0.2, 5e5, 0.2}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const FeaturePoints dx{Vec3{0, -1e6, 0}, {}, {}, {}};
  const auto hit = first_approach<PointTriangle>(x, dx, 1e-3, PointTriangle::closest(x));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 0.5, 1e-8);
  EXPECT_NEAR(hit->at.normal.y, 1, 1e-9);
  // Common motion does not matter.
  const Vec3 along{0, -1e6, 0};
  EXPECT_FALSE(
      first_approach<PointTriangle>(x, {along, along, along, along}, 1e-3, PointTriangle::closest(x)));
}

}  // namespace
}  // namespace truestep
