// Surfaces that enclose a volume: what one that does not is told, and the ground under heights.
#include "engine/geometry/make/enclosure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace truestep {
namespace {

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
};
Surface tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}};
}
std::string told(const Surface& s) {
  const auto fault = enclosure_fault(s.vertices, s.triangles);
  return fault ? std::to_string(fault->index) + ": " + fault->what : "";
}

TEST(Enclosure, EveryFaultIsToldApart) {
  EXPECT_EQ(told(tetrahedron()), "") << "control: nothing is wrong";
  Surface s = tetrahedron();
  s.triangles.resize(9);
  EXPECT_EQ(told(s),
            "4: the edge from vertex 1 to 3 has a triangle on one side only: the surface must be closed");
  s = tetrahedron();
  std::swap(s.triangles[0], s.triangles[1]);
  EXPECT_NE(told(s).find("in the same direction"), std::string::npos) << told(s);
  s = tetrahedron();
  for (size_t k = 0; k < 12; k += 3) std::swap(s.triangles[k], s.triangles[k + 1]);
  EXPECT_EQ(told(s), "12: the triangles run clockwise seen from outside: reverse each");
  s = tetrahedron();
  s.triangles[11] = 2;
  EXPECT_EQ(told(s), "9: the triangle has no area");
  s = tetrahedron();
  s.triangles[4] = 4;
  EXPECT_EQ(told(s), "4: there is no such vertex");
  s.triangles.pop_back();
  EXPECT_EQ(told(s), "11: the length must be a multiple of three");
}

// Far from the origin and small: a volume that is a rounding of products of coordinates.
TEST(Enclosure, PlaceAndSizeDoNotMatter) {
  for (const double size : {1e-3, 1e3}) {
    Surface s = tetrahedron();
    for (Vec3& v : s.vertices) v = v * size + Vec3{1e4, -1e4, 1e4} * size;
    EXPECT_EQ(told(s), "");
  }
}

TEST(Enclosure, GroundIsClosedAndHasItsVolume) {
  const std::vector<double> heights{0, 0.5, 0.25, 0.125, 0.25, 0};
  const EnclosingMesh ground = ground_block(3, 2, 0.5, heights, 2, 1);
  const std::vector<int64_t> indices(ground.triangles.begin(), ground.triangles.end());
  EXPECT_EQ(told({ground.vertices, indices}), "");
  double volume = 0;
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (size_t k = 0; k < indices.size(); k += 3) {
    const Vec3 &a = ground.vertices[ground.triangles[k]], &b = ground.vertices[ground.triangles[k + 1]],
               &c = ground.vertices[ground.triangles[k + 2]];
    volume += dot(a, cross(b, c)) / 6;
  }
  for (const Vec3& v : ground.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  EXPECT_EQ(low, (Vec3{-2.5, -1, -2.25}));
  EXPECT_EQ(high, (Vec3{2.5, 0.5, 2.25}));
  // Each cell's two triangles have the mean of their corners' heights over them.
  double sum = 5 * 4.5;
  const auto h = [&](int i, int j) {
    return heights[static_cast<size_t>(std::clamp(j - 1, 0, 1) * 3 + std::clamp(i - 1, 0, 2))];
  };
  const double wide[] = {2, 0.5, 0.5, 2}, deep[] = {2, 0.5, 2};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) {
      const double one = h(i, j) + h(i, j + 1) + h(i + 1, j),
                   two = h(i + 1, j) + h(i, j + 1) + h(i + 1, j + 1);
      sum += wide[i] * deep[j] * (one + two) / 6;
    }
  }
  EXPECT_NEAR(volume, sum, 1e-12 * sum);
}

}  // namespace
}  // namespace truestep
