// Two bodies at a node: the normal between them, and the contact impulse.
#include <gtest/gtest.h>

#include <vector>

#include "engine/kernels/mpm/field_contact.h"

namespace truestep::mpm {
namespace {

/// Particles half a cell apart, shifted by a share of that, as a cloud around a node at the origin.
struct Places {
  std::vector<float> x, y, z, side;

  template <class SideOf>
  Places(int dimension, double shift, const SideOf& side_of) {
    const int deep = dimension == 3 ? 3 : 0;
    for (int i = -3; i <= 3; ++i) {
      for (int j = -3; j <= 3; ++j) {
        for (int k = -deep; k <= deep; ++k) {
          const Vec3 p{0.5 * (i + shift), 0.5 * (j + 0.7 * shift), dimension == 3 ? 0.5 * (k - shift) : 0};
          const int s = side_of(p);
          if (s == 0 || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) >= 1.5) continue;
          add(p, s);
        }
      }
    }
    while (x.size() % 8 != 0) add({}, 0);
  }
  void add(const Vec3& p, int s) {
    x.push_back(static_cast<float>(p.x)), y.push_back(static_cast<float>(p.y));
    z.push_back(static_cast<float>(p.z)), side.push_back(static_cast<float>(s));
  }
  Vec3 normal() const { return normal_between({x, y, z, side}); }
};

// Flat surfaces a quarter of a cell to either side of a plane in any direction: within five degrees, the
// angle of one particle step over three cells.
TEST(MpmFieldContact, TheNormalOfFlatSurfacesIsTheirs) {
  for (const int dimension : {2, 3}) {
    for (const double shift : {0.0, 0.3, -0.45}) {
      for (const Vec3& n : {Vec3{0, 1, 0}, Vec3{0.6, 0.8, 0}, Vec3{-0.8, 0.6, 0}}) {
        const Places p(dimension, shift, [&](const Vec3& at) {
          const double d = dot(at, n) - 0.2;
          return d > 0.25 ? 1 : d < -0.25 ? -1 : 0;
        });
        EXPECT_GT(dot(p.normal(), n), std::cos(10 * 3.14159 / 180)) << dimension << shift << n.x;
        const Places turned(dimension, shift, [&](const Vec3& at) {
          const double d = dot(at, n) - 0.2;
          return d > 0.25 ? -1 : d < -0.25 ? 1 : 0;
        });
        EXPECT_LT(norm(turned.normal() + p.normal()), 1e-3) << "the other way round";
      }
    }
  }
}

// A body that ends at the node, on a surface that continues: the difference of the centres of mass, the
// control, points along the diagonal.
TEST(MpmFieldContact, TheNormalAtACornerIsThatOfTheSurfaceItLiesOn) {
  const Places p(2, 0.5, [](const Vec3& at) { return at.y < 0 ? -1 : at.x > 0.5 ? 1 : 0; });
  Vec3 a, b;
  double many_a = 0, many_b = 0;
  for (size_t k = 0; k < p.x.size(); ++k) {
    const Vec3 at{double{p.x[k]}, double{p.y[k]}, 0};
    if (p.side[k] < 0) a += at, ++many_a;
    if (p.side[k] > 0) b += at, ++many_b;
  }
  const Vec3 between = b / many_b - a / many_a;
  EXPECT_LT(between.y / norm(between), 0.9) << "control";
  EXPECT_GT(p.normal().y, std::cos(8 * 3.14159 / 180));
}

TEST(MpmFieldContact, ThereIsNoNormalOfOneBodyAlone) {
  const Places one(3, 0.1, [](const Vec3&) { return 1; });
  EXPECT_EQ(norm(one.normal()), 0);
  Places both(2, 0.1, [](const Vec3&) { return 0; });
  for (int k = 0; k < 4; ++k) both.add({0.2, 0.1, 0}, -1), both.add({0.2, 0.1, 0}, 1);
  EXPECT_EQ(norm(both.normal()), 0) << "at one place";
}

// Masses 2 and 3 approach at 1 m/s and slide at 4 m/s.
TEST(MpmFieldContact, NodesMeetByCoulombsLaw) {
  const FieldNode a{2, {0, 0.5, 0.1}}, b{3, {4, -0.5, 0.1}};
  const Vec3 n{0, 1, 0};
  const double reduced = 1.2;
  for (const double friction : {0.0, 0.5, 10.0}) {
    for (const double closing : {0.0, 0.25, 2.0}) {
      FieldNode one = a, other = b;
      EXPECT_EQ(meet(one, other, n, closing, friction), closing < 1);
      const Vec3 got = (other.velocity - b.velocity) * 3;
      EXPECT_LT(norm((one.velocity - a.velocity) * 2 + got), 1e-15) << "momentum";
      if (closing >= 1) {
        EXPECT_EQ(norm(got), 0) << "they are too far apart to touch";
        continue;
      }
      EXPECT_NEAR(got.y, reduced * (1 - closing), 1e-15);
      // Slides at 4 m/s, or less if the bound's impulse would stop it.
      EXPECT_NEAR(got.x, -std::min(friction * got.y, reduced * 4), 1e-14);
      EXPECT_NEAR(dot(other.velocity - one.velocity, n), -closing, 1e-15);
    }
  }
  FieldNode one = b, other = a;
  EXPECT_FALSE(meet(one, other, n, 0, 1)) << "what parts is let go";
}

}  // namespace
}  // namespace truestep::mpm
