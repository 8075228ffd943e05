// Points against the hulls of one to three others: the nearest place and the first contact of moving ones.
#include "engine/kernels/contact/point_hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"

namespace truestep {
namespace {

Vec3 random_place(uint64_t stream, uint64_t i) {
  const auto u = uniform4(11, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

// The weights give the nearest point: no point of a fine sampling is nearer.
TEST(PointHull, NearestPlaceIsTheNearest) {
  for (uint64_t i = 0; i < 200; ++i) {
    std::array<Vec3, 3> c{random_place(1, i), random_place(2, i), random_place(3, i)};
    if (i % 10 == 0) c[2] = c[0] + (c[1] - c[0]) * 0.3;  // no area
    const Vec3 p = random_place(4, i) * 2;
    for (size_t corners = 1; corners <= 3; ++corners) {
      const HullWeights w = nearest_on_hull(p, c, corners);
      EXPECT_NEAR(w[0] + w[1] + w[2], 1, 1e-14);
      const double d = norm(p - blend(c, w, corners));
      constexpr int kParts = 40;
      for (int a = 0; a <= (corners > 1 ? kParts : 0); ++a) {
        for (int b = 0; b <= (corners > 2 ? kParts - a : 0); ++b) {
          const double u = double(a) / kParts, v = double(b) / kParts;
          // Rounding of distances of size 3.
          ASSERT_GE(norm(p - blend(c, {1 - u - v, u, v}, corners)), d - 1e-14);
        }
      }
    }
  }
}

// The contact is where a fine search along the paths first comes within reach.
TEST(PointHull, FirstContactIsTheFirst) {
  int hits = 0;
  for (uint64_t i = 0; i < 500; ++i) {
    const size_t corners = 1 + i % 3;
    std::array<HullPath, 3> c;
    for (uint64_t k = 0; k < 3; ++k) {
      c[k] = {random_place(10 + k, i), random_place(20 + k, i) * 0.5, random_place(30 + k, i) * 0.5};
    }
    const Vec3 from = normalized(random_place(5, i)) * 3;
    const HullPath p{from, random_place(6, i) * 0.5 - from * 1.5, random_place(7, i)};
    const double reach = i % 2 ? 0.1 : 1e-9;
    const auto hit = first_hull_contact(p, c, corners, reach);
    const auto apart = [&](double s) {
      std::array<Vec3, 3> at;
      for (size_t k = 0; k < 3; ++k) at[k] = c[k].at(s);
      return norm(p.at(s) - blend(at, nearest_on_hull(p.at(s), at, corners), corners));
    };
    const double until = hit ? hit->s : 1;
    // Until the contact the point is outside; the last hundredth of the path is left to rounding.
    for (int k = 0; k < 400; ++k) {
      const double s = until * k / 400 * 0.9999;
      ASSERT_GE(apart(s), reach * (1 - 1e-6)) << i << " at " << s;
      if (hit && hit->s == 0) break;
    }
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(norm(hit->n), 1, 1e-12);
    if (hit->s > 0) {
      EXPECT_NEAR(hit->apart, reach, 2e-3 * reach + 2e-12) << i;
    }
  }
  EXPECT_GT(hits, 50);
}

// A point at the target to the last bit, sliding along a face: a touch is within the step or does not exist.
TEST(PointHull, TouchesOfWhatRestsAreWithinTheStep) {
  int hits = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const double reach = 0.04;
    const Vec3 n = normalized(random_place(40, i)), at = random_place(41, i);
    const Vec3 e = normalized(cross(n, random_place(42, i))), f = cross(n, e);
    const std::array<HullPath, 3> c{
        {{at + e * 0.1, {}, {}}, {at - e * 0.05 + f * 0.08, {}, {}}, {at - e * 0.05 - f * 0.08, {}, {}}}};
    HullPath p;
    p.x = at + n * reach;
    p.v = e * (1e-3 * random_place(43, i).x) + n * (1e-12 * random_place(43, i).y * double(i % 2));
    p.a = n * (-1e-12 * double(i % 3));
    const auto hit = first_hull_contact(p, c, 3, reach);
    if (!hit) continue;
    ++hits;
    ASSERT_GE(hit->s, 0) << i;
    ASSERT_LE(hit->s, 1) << i;
    ASSERT_NEAR(hit->apart, reach, 2e-3 * reach) << i;
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace truestep
