#include "engine/geometry/shape_distance.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/shape.h"
#include "engine/kernels/contact/first_contact.h"

namespace truestep {
namespace {

Vec3 random_point(uint64_t stream, uint64_t i, double half) {
  const auto u = uniform4(11, stream, i);
  return Vec3{2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1} * half;
}

const Shape kShapes[] = {{ShapeKind::plane, PointSide::outside, {0.6, 0.8, 0}},
                         {ShapeKind::box, PointSide::outside, {0.7, 0.2, 0.5}},
                         {ShapeKind::sphere, PointSide::outside, {0.8, 0, 0}},
                         {ShapeKind::capsule, PointSide::outside, {0.3, 0.6, 0}}};

TEST(ShapeDistance, KnownPoints) {
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[0], {0, 2, 0}).d, 1.6);
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[1], {1.7, 0, 0}).d, 1.0);
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[1], {0, 0, 0}).d, -0.2);
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[1], {1.0, 0.6, 0}).d, 0.5);  // 3-4-5 at an edge
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[2], {0, 0, 1}).d, 1 - 0.8);
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[3], {0, 1.2, 0}).d, 0.6 - 0.3);
  EXPECT_DOUBLE_EQ(solid_distance(kShapes[3], {0.5, 0.1, 0}).d, 0.2);
}

TEST(ShapeDistance, NormalIsTheGradient) {
  for (const Shape& s : kShapes) {
    int checked = 0;
    for (uint64_t i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(1, i, 1.5);
      const auto at = solid_distance(s, p);
      EXPECT_NEAR(norm(at.n), 1, 1e-14);
      constexpr double e = 1e-6;
      const auto slope = [&](Vec3 d) {
        return (solid_distance(s, p + d * e).d - solid_distance(s, p - d * e).d) / (2 * e);
      };
      const Vec3 g{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
      // Central differences err by e^2 times the third derivative plus 1e-16 / e: 1e-6 is ample. Points
      // within e of a ridge inside the box have no gradient; they are rare.
      if (norm(g - at.n) < 1e-6) ++checked;
    }
    EXPECT_GE(checked, 1995);
  }
}

TEST(ShapeDistance, ConvexAlongEverySegment) {
  for (const Shape& s : kShapes) {
    for (uint64_t i = 0; i < 5000; ++i) {
      const Vec3 a = random_point(2, i, 2), b = random_point(3, i, 2);
      const double middle = solid_distance(s, (a + b) * 0.5).d;
      EXPECT_LE(middle, 0.5 * (solid_distance(s, a).d + solid_distance(s, b).d) + 1e-14);
    }
  }
}

/// Brute force: smallest distance over many samples of the segment.
double sampled_minimum(const Shape& s, const Vec3& a, const Vec3& b) {
  double least = 1e300;
  for (int k = 0; k <= 4000; ++k) least = std::min(least, solid_distance(s, a + (b - a) * (k / 4000.0)).d);
  return least;
}

TEST(FirstContact, AgreesWithDenseSampling) {
  for (const Shape& s : kShapes) {
    const auto distance = [&s](const Vec3& p) { return solid_distance(s, p); };
    int hits = 0, misses = 0;
    for (uint64_t i = 0; i < 400; ++i) {
      const Vec3 a = random_point(4, i, 2), b = random_point(5, i, 2);
      if (distance(a).d <= 0.01) continue;
      const auto hit = first_entry(distance, a, b - a, 0.0);
      if (hit) {
        ++hits;
        // On the surface to rounding (1e-15 of coordinates up to 4), and nothing touched before it.
        EXPECT_NEAR(distance(a + (b - a) * *hit).d, 0, 1e-13);
        for (int k = 0; k < 50; ++k) EXPECT_GT(distance(a + (b - a) * (*hit * k / 50.0)).d, -1e-13);
      } else {
        ++misses;
        EXPECT_GT(sampled_minimum(s, a, b), 0);
      }
    }
    EXPECT_GT(hits, 20);
    EXPECT_GT(misses, 20);
  }
}

TEST(FirstContact, ExitFromAContainerIsOnTheWall) {
  for (size_t k = 1; k < 4; ++k) {
    const Shape& s = kShapes[k];
    const auto distance = [&s](const Vec3& p) { return solid_distance(s, p); };
    int exits = 0;
    for (uint64_t i = 0; i < 4000; ++i) {
      const Vec3 a = random_point(6, i, 1), b = random_point(7, i, 2);
      if (distance(a).d > -0.05) continue;
      const auto out = first_exit(distance, a, b - a, 0.0);
      EXPECT_EQ(out.has_value(), distance(b).d > 0);
      if (!out) continue;
      ++exits;
      EXPECT_NEAR(distance(a + (b - a) * *out).d, 0, 1e-13);
    }
    EXPECT_GT(exits, 50);
  }
}

TEST(FirstContact, SphereTimeIsTheQuadraticsRoot) {
  const auto distance = [](const Vec3& p) { return sphere_distance(p, 0.5); };
  const Vec3 a{-3, 0.3, 0}, d{6, 0, 0};
  const auto hit = first_entry(distance, a, d, 0.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(*hit, (3 - 0.4) / 6, 1e-14);  // x = -sqrt(0.25 - 0.09)
}

}  // namespace
}  // namespace truestep
