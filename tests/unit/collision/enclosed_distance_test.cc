// A mesh without a border has the enclosed volume as its inside: distances from it equal those from the
// corresponding solid.
#include <gtest/gtest.h>

#include <random>

#include "engine/collision/point_distance.h"

namespace truestep {
namespace {

const Vec3 kHalf{0.3, 0.2, 0.4};

Solid mesh_of_box(bool lid) {
  std::vector<Vec3> x;
  for (int k = 0; k < 8; ++k) {
    x.push_back({(k & 1 ? 1 : -1) * kHalf.x, (k & 2 ? 1 : -1) * kHalf.y, (k & 4 ? 1 : -1) * kHalf.z});
  }
  std::vector<uint32_t> t{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5,
                          0, 5, 4, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  if (lid) t.insert(t.end(), {2, 6, 7, 2, 7, 3});
  return mesh_solid(x, t);
}

TEST(EnclosedDistance, OfAMeshIsThatOfItsSolid) {
  const Solid box = box_solid(kHalf), mesh = mesh_of_box(true);
  ASSERT_EQ(mesh_sides(mesh), MeshSides::enclosed);
  std::mt19937 random(5);
  const auto real = [&] { return 1.2 * (random() / 4294967296.0) - 0.6; };
  int inside = 0, missed = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p{real(), real(), real()};
    const auto is = point_distance(box, p, 2), has = point_distance(mesh, p, 2, MeshSides::enclosed);
    ASSERT_TRUE(is && has);
    EXPECT_NEAR(has->distance, is->distance, 1e-12);
    EXPECT_NEAR(norm(has->normal - is->normal), 0, 1e-6);
    inside += is->distance < 0;
    const auto front = point_distance(mesh, p, 2);
    missed += is->distance < 0 && !front;
  }
  EXPECT_GT(inside, 100);
  EXPECT_EQ(missed, inside) << "control: its fronts know of nothing inside";
  EXPECT_FALSE(point_distance(mesh, {0, 1, 0}, 0.5, MeshSides::enclosed));
}

TEST(EnclosedDistance, NeedsAMeshWithoutABorder) {
  EXPECT_EQ(mesh_sides(mesh_of_box(false)), MeshSides::front);
  EXPECT_EQ(mesh_sides(sphere_solid(1)), MeshSides::enclosed);
}

}  // namespace
}  // namespace truestep
