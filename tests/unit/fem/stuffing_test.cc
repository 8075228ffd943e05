// Regions filled with tetrahedra: volumes, angles, closed surfaces, and invalid surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "engine/geometry/make/stuffing.h"

namespace truestep {
namespace {

double volume_of(const Stuffing& s) {
  double v = 0;
  for (const auto& t : s.tetrahedra) {
    const double six = dot(cross(s.x[t[1]] - s.x[t[0]], s.x[t[2]] - s.x[t[0]]), s.x[t[3]] - s.x[t[0]]);
    EXPECT_GT(six, 0);
    v += six / 6;
  }
  return v;
}

// Faces have one element or two: elements fit together and nothing overlaps.
size_t border_faces(const Stuffing& s) {
  std::map<std::array<uint32_t, 3>, int> faces;
  for (const auto& t : s.tetrahedra) {
    for (size_t out = 0; out < 4; ++out) {
      std::array<uint32_t, 3> f;
      for (size_t a = 0, b = 0; a < 4; ++a) {
        if (a != out) f[b++] = t[a];
      }
      std::sort(f.begin(), f.end());
      ++faces[f];
    }
  }
  size_t border = 0;
  std::map<std::array<uint32_t, 2>, int> edges;
  for (const auto& [f, count] : faces) {
    EXPECT_LE(count, 2);
    if (count == 2) continue;
    ++border;
    ++edges[{f[0], f[1]}], ++edges[{f[1], f[2]}], ++edges[{f[0], f[2]}];
  }
  // The border is closed.
  for (const auto& [e, count] : edges) EXPECT_EQ(count % 2, 0);
  return border;
}

// Bounds that Labelle and Shewchuk prove for their patterns: 10.7 and 164.8 degrees.
constexpr double kLeastAngle = 10.7 * std::numbers::pi / 180, kLargestAngle = 164.8 * std::numbers::pi / 180;

TEST(Stuffing, ABallHasItsVolumeWithTheOrderOfItsFacets) {
  double errors[2];
  for (const int k : {0, 1}) {
    const auto ball = ball_region({0.1, 0.2, -0.3}, 1);
    const Stuffing s = stuff(*ball, k == 0 ? 0.4 : 0.2);
    EXPECT_GT(s.least_angle, kLeastAngle);
    EXPECT_LT(s.largest_angle, kLargestAngle);
    EXPECT_GT(border_faces(s), 100u);
    errors[k] = std::abs(volume_of(s) / ball->volume() - 1);
    const StuffingSize about = stuffing_size(ball->volume(), k == 0 ? 0.4 : 0.2);
    EXPECT_LT(static_cast<double>(s.x.size()), about.nodes);
    EXPECT_LT(static_cast<double>(s.tetrahedra.size()), about.tetrahedra);
    EXPECT_GT(static_cast<double>(s.tetrahedra.size()), 0.3 * about.tetrahedra);
  }
  // Facets cut off a volume of second order in their size.
  EXPECT_LT(errors[0], 0.06);
  EXPECT_NEAR(errors[0] / errors[1], 4, 1.5);
}

TEST(Stuffing, CylindersKeepTheirVolumeButForRoundedEdges) {
  const auto rod = cylinder_region({0, 0, 0}, {1, 2, 0.5}, 0.4);
  const Stuffing s = stuff(*rod, 0.1);
  EXPECT_GT(s.least_angle, kLeastAngle);
  EXPECT_LT(s.largest_angle, kLargestAngle);
  border_faces(s);
  // Edges are cut off within a lattice cell: some tenths of a^2 per unit of their length 2 pi r.
  EXPECT_NEAR(volume_of(s), rod->volume(), 2 * 2 * std::numbers::pi * 0.4 * 0.01);
}

// An octahedron as a surface: the lattice finds the region enclosed by its triangles.
TEST(Stuffing, ASurfaceHoldsItsVolume) {
  std::vector<Vec3> x{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<uint32_t, 3>> t{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  EXPECT_FALSE(surface_fault(t).has_value());
  const auto region = surface_region(x, t);
  EXPECT_NEAR(region->volume(), 4.0 / 3, 1e-12);
  EXPECT_TRUE(region->inside({0.1, 0.1, 0.1}));
  EXPECT_TRUE(region->inside({0, 0, 0}));
  EXPECT_FALSE(region->inside({0.5, 0.5, 0.5}));
  EXPECT_NEAR(region->leaves({0.01, 0.02, 0}, {2, 2, 2}), 0.97 / 5.97, 1e-6);
  const Stuffing s = stuff(*region, 0.1);
  border_faces(s);
  EXPECT_GT(s.least_angle, kLeastAngle);
  EXPECT_LT(s.largest_angle, kLargestAngle);
  // Twelve edges of length sqrt 2 lose up to some tenths of a cell's square each.
  EXPECT_NEAR(volume_of(s), 4.0 / 3, 12 * std::sqrt(2.0) * 0.3 * 0.01);
  // Too coarse for anything to be left.
  EXPECT_TRUE(stuff(*surface_region({{0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}},
                                    {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}),
                    1)
                  .tetrahedra.empty());
  // A surface that is not closed is reported with the edge.
  t[3] = {0, 3, 4};
  EXPECT_NE(surface_fault(t)->what.find("same direction"), std::string::npos);
  t.pop_back();
  EXPECT_TRUE(surface_fault(t).has_value());
  t.push_back({0, 3, 5}), t[3] = {3, 0, 4}, t.push_back({3, 0, 2});
  EXPECT_NE(surface_fault(t)->what.find("triangles"), std::string::npos);
  EXPECT_NE(surface_fault(std::vector<std::array<uint32_t, 3>>{{0, 1, 2}})->what.find("open"),
            std::string::npos);
}

}  // namespace
}  // namespace truestep
