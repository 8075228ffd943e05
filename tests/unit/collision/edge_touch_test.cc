// Edges of bodies against lines between points: the common perpendicular and the side that is kept. (Ribbons
// and ropes on ridges are in tests/scenes/couplings.)
#include "engine/couplings/contact/edge_touch.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/kernels/contact/edge_edge.h"

namespace truestep {
namespace {

Vec3 random_point(uint64_t stream, uint64_t i) {
  const auto u = uniform4(31, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

TEST(EdgeEdge, IsTheCommonPerpendicular) {
  int found = 0;
  for (uint64_t i = 0; i < 300; ++i) {
    const Vec3 a0 = random_point(1, i), a1 = random_point(2, i), b0 = random_point(3, i),
               b1 = random_point(4, i);
    const auto n = nearest_inside(a0, a1, b0, b1);
    double least = 1e9;  // of places on a grid over both: never nearer
    for (int k = 0; k <= 20; ++k) {
      for (int l = 0; l <= 20; ++l) {
        least = std::min(least, norm(a0 + (a1 - a0) * (k / 20.0) - b0 - (b1 - b0) * (l / 20.0)));
      }
    }
    if (!n) continue;
    ++found;
    EXPECT_NEAR(dot(n->apart, a1 - a0), 0, 1e-13);
    EXPECT_NEAR(dot(n->apart, b1 - b0), 0, 1e-13);
    EXPECT_LE(norm(n->apart), least + 1e-12);
    EXPECT_LT(norm(a0 + (a1 - a0) * n->a - b0 - (b1 - b0) * n->b - n->apart), 1e-14);
  }
  EXPECT_GT(found, 30);
  EXPECT_FALSE(nearest_inside({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}).has_value());
}

TEST(EdgeTouch, KeepsTheSideOfTheStart) {
  using contact::edges_meet;
  const Vec3 up{0, 1, 0};
  const contact::MovingEdge ridge{{0, 0, -1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  const auto line = [](double y0, double y1) {
    return contact::MovingEdge{{-1, y0, 0.2}, {1, y0, 0.2}, {-1, y1, 0.2}, {1, y1, 0.2}};
  };
  const auto comes = edges_meet(line(0.1, 0.01), ridge, up, 0.02, 0.04);
  ASSERT_TRUE(comes.has_value());
  EXPECT_EQ(comes->n, up);
  EXPECT_NEAR(comes->s, 0.08 / 0.09, 1e-12);
  EXPECT_NEAR(comes->along, 0.5, 1e-15);
  const auto passes = edges_meet(line(0.1, -0.05), ridge, up, 0.02, 0.04);
  ASSERT_TRUE(passes.has_value());
  EXPECT_EQ(passes->n, up);
  // Far away, or from behind: no meeting.
  EXPECT_FALSE(edges_meet(line(0.1, 0.05), ridge, up, 0.02, 0.04).has_value());
  EXPECT_FALSE(edges_meet(line(-0.01, 0.01), ridge, up, 0.02, 0.04).has_value());
  // An axis has no back side.
  EXPECT_TRUE(edges_meet(line(-0.1, -0.01), ridge, {}, 0.02, 0.04).has_value());
}

}  // namespace
}  // namespace truestep
