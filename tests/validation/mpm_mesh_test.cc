// A box that is pressed into jelly, given as a box and as a mesh of triangles: the same push.
#include "engine/geometry/solid.h"
#include "tests/unit/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

Solid mesh_of_box(const Vec3& half) {
  std::vector<Vec3> x;
  for (int k = 0; k < 8; ++k) {
    x.push_back({(k & 1 ? 1 : -1) * half.x, (k & 2 ? 1 : -1) * half.y, (k & 4 ? 1 : -1) * half.z});
  }
  return mesh_solid(x, {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5});
}

/// N s that jelly gives in an eighth of a second to a box that nothing stops.
double push(const Solid& solid) {
  MpmDef d;
  d.dimension = 3, d.precision = Precision::f64, d.cell = 0.1;
  BodyDef jelly;
  jelly.center = {0.5, 0.2, 0.5}, jelly.half_extents = {0.4, 0.2, 0.4};
  d.bodies = {jelly};
  MpmRun run(d, 1.0 / 60, {0, -9.81, 0});
  ImmersedBody box{.solid = &solid, .place = {0.53, 0.58, 0.51}, .velocity = {0, -1, 0}};
  run.step(8, {&box, 1});
  return box.impulse.y;
}

// Distances to a mesh and to a box agree to rounding; nodes at the same distance from two faces may take
// either normal, of which there are few: a hundredth.
TEST(MpmMesh, JellyPushesAMeshAsItDoesABox) {
  const Vec3 half{0.17, 0.16, 0.15};
  const double box = push(box_solid(half)), mesh = push(mesh_of_box(half));
  EXPECT_GT(box, 1);
  EXPECT_NEAR(mesh, box, 0.01 * box);
  EXPECT_LT(push(mesh_of_box({0.17, 0.1, 0.15})), 0.9 * box) << "control: a lower box";
}

}  // namespace
}  // namespace truestep::mpm
