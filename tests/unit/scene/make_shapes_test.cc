// Shapes of ropes, hair, cloth and soft blocks: counts, lengths, areas, volumes.
#include <gtest/gtest.h>

#include <map>

#include "engine/geometry/make/hair.h"
#include "engine/geometry/make/rope.h"
#include "engine/geometry/make/soft_block.h"
#include "engine/geometry/make/surface.h"

namespace truestep {
namespace {

TEST(MakeRope, SlackRopeHasItsLengthAndEqualLinks) {
  const RopeShape shape{.from = {0, 1, 0}, .to = {1, 1, 0}, .links = 50, .length = 1.5};
  const auto x = rope_points(shape, {0, -1, 0});
  ASSERT_EQ(x.size(), 51u);
  EXPECT_EQ(x.front(), shape.from);
  EXPECT_EQ(x.back(), shape.to);
  double length = 0;
  for (size_t i = 0; i + 1 < x.size(); ++i) {
    length += norm(x[i + 1] - x[i]);
    // A chord is shorter than its arc of 0.03 m by length^3 curvature^2 / 24.
    EXPECT_NEAR(norm(x[i + 1] - x[i]), rope_link(shape), 5e-5);
  }
  EXPECT_NEAR(length, 1.5, 2e-3);
  EXPECT_LT(x[25].y, 0.6);
}

TEST(MakeHair, RootsLieOnTheDisc) {
  const HairShape shape{.radius = 0.2, .strands = 30, .links = 4, .length = 0.4};
  const auto x = hair_points(shape);
  ASSERT_EQ(x.size(), 150u);
  for (size_t s = 0; s < 30; ++s) {
    EXPECT_LE(norm(x[5 * s]), 0.2);
    EXPECT_NEAR(norm(x[5 * s + 4] - x[5 * s]), 0.4, 1e-15);
  }
}

TEST(MakeSoftBlock, TetrahedraFillTheBox) {
  const SoftBlockShape shape{
      .origin = {1, 2, 3}, .size = {1, 2, 0.5}, .cells_x = 3, .cells_y = 4, .cells_z = 2};
  const SoftBlock block = make_soft_block(shape);
  EXPECT_EQ(block.x.size(), 60u);
  EXPECT_EQ(block.tetrahedra.size(), 5u * 24);
  double volume = 0, shares = 0;
  std::map<std::array<uint32_t, 3>, int> faces;
  for (const auto& t : block.tetrahedra) {
    const Vec3 &a = block.x[t[0]], &b = block.x[t[1]], &c = block.x[t[2]], &d = block.x[t[3]];
    const double v = dot(b - a, cross(c - a, d - a)) / 6;
    EXPECT_GT(v, 0);
    volume += v;
    for (size_t skip = 0; skip < 4; ++skip) {
      std::array<uint32_t, 3> f;
      for (size_t k = 0, n = 0; k < 4; ++k) {
        if (k != skip) f[n++] = t[k];
      }
      std::sort(f.begin(), f.end());
      ++faces[f];
    }
  }
  for (const double s : block.share) shares += s;
  EXPECT_NEAR(volume, 1, 1e-12);
  EXPECT_NEAR(shares, 1, 1e-12);
  // Neighbours fit together: a face has two tetrahedra, or one and lies on the surface.
  size_t outer = 0;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    outer += count == 1;
  }
  EXPECT_EQ(outer, 2u * 2 * (3 * 4 + 4 * 2 + 3 * 2));
  EXPECT_EQ(block.triangles.size(), outer);
  // The surface encloses the volume: all of it faces outward.
  double enclosed = 0;
  for (const auto& t : block.triangles)
    enclosed += dot(block.x[t[0]], cross(block.x[t[1]], block.x[t[2]])) / 6;
  EXPECT_NEAR(enclosed, 1, 1e-12);
}

TEST(MakeSurface, EdgesOfTwoTrianglesAreNeighbours) {
  const MeshShape shape{.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                        .triangles = {0, 1, 2, 0, 2, 3}};
  const auto edges = sorted_edges(mesh_triangles(shape));
  ASSERT_EQ(edges.size(), 6u);
  EXPECT_EQ(edges[1], (std::array<uint32_t, 3>{0, 2, 1}));
  EXPECT_EQ(edges[2], (std::array<uint32_t, 3>{0, 2, 3}));
  EXPECT_NEAR(mesh_shares(shape)[0], 1.0 / 3, 1e-15);
}

}  // namespace
}  // namespace truestep
