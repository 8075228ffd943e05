// A capsule that leans over the edge of a face touches at the edge, with a normal between the face's and its
// own: the manifold goes over into that of a lying one without a jump. It used to have one point from 1.4
// mrad on, and boxes wedged under capsules rocked between one point and two for ever.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/collision/collision.h"
#include "engine/math/quaternion.h"

namespace truestep {
namespace {

constexpr double kRadius = 0.3, kHalfLength = 0.6, kMargin = 0.02;

/// A capsule across the top of a box of 1 m, over one edge of it, turned by `tilt` about that edge (rad).
Manifold leaning(double tilt, double gap = 0, double margin = kMargin) {
  const Solid box = box_solid({0.5, 0.5, 0.5}), capsule = capsule_solid(kRadius, kHalfLength);
  const Vec3 axis{std::cos(tilt), std::sin(tilt), 0}, normal{-std::sin(tilt), std::cos(tilt), 0};
  // Its middle is 0.2 m outside the edge at (0.5, 0.5): one end stands out, one is over the box.
  const Vec3 middle = Vec3{0.5, 0.5, 0} + normal * (kRadius + gap) + axis * 0.2;
  Manifold m;
  collide(box, {}, capsule, transform_of({middle, rotation_between({0, 1, 0}, axis)}), margin, m);
  return m;
}

TEST(LeaningCapsule, KeepsTheNormalAndBothPointsOfALyingOne) {
  // The end over the box is 0.4 m from the edge.
  constexpr double kReach = kHalfLength - 0.2;
  for (double tilt = 2e-4; tilt < 0.1; tilt *= 1.3) {
    // Leaning outwards: the end over the box rises.
    const Manifold m = leaning(-tilt, -1e-4);
    ASSERT_EQ(m.count, tilt * kReach < kMargin ? 2 : 1) << tilt;
    EXPECT_NEAR(m.normal.x, tilt, 1.5e-3) << tilt;  // below 1.4 mrad it lies
    // Lying, it is measured along the face's normal: up to r tilt^2 / 2 less deep.
    EXPECT_NEAR(m.deepest(), 1e-4, tilt < 1.5e-3 ? kRadius * tilt * tilt : 1e-12) << tilt;
    if (m.count == 1) continue;
    const double far = std::max(m.points[0].separation, m.points[1].separation);
    EXPECT_NEAR(far, tilt * kReach - 1e-4, 0.01 * tilt * kReach + 1e-5) << tilt;
  }
}

TEST(LeaningCapsule, HasNoSecondPointWhereItStandsOnTheEdge) {
  // The control: at 0.3 rad the face is no floor for it, whatever the margin; at 0.15 rad it is.
  EXPECT_EQ(leaning(-0.3, 0, 1).count, 1);
  EXPECT_EQ(leaning(-0.15, 0, 1).count, 2);
}

TEST(LeaningCapsule, ChangesNothingSuddenly) {
  Manifold before = leaning(-1e-4);
  for (double tilt = 1.2e-4; tilt < 0.04; tilt *= 1.2) {
    const Manifold m = leaning(-tilt);
    EXPECT_LT(norm(m.normal - before.normal), 1.5e-3 + tilt / 5) << tilt;
    ASSERT_EQ(m.count, before.count) << tilt;
    for (int i = 0; i < m.count; ++i) EXPECT_EQ(m.points[i].id, before.points[i].id);
    before = m;
  }
}

}  // namespace
}  // namespace truestep
