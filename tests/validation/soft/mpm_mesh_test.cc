// A box pressed into jelly, as a box and as a mesh of triangles: the same push.
#include "tests/unit/mpm/mpm_rig.h"
#include "tests/unit/scene/mesh_box_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::mesh_of_box;
using testing_rig::MpmRun;

/// N s that jelly gives in an eighth of a second to a box of constant velocity.
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

// Distances to a mesh and to a box agree to rounding; nodes equally far from two faces may take either
// normal, and there are few of them: a hundredth.
TEST(MpmMesh, JellyPushesAMeshAsItDoesABox) {
  const Vec3 half{0.17, 0.16, 0.15};
  const double box = push(box_solid(half)), mesh = push(mesh_of_box(half));
  EXPECT_GT(box, 1);
  EXPECT_NEAR(mesh, box, 0.01 * box);
  EXPECT_LT(push(mesh_of_box({0.17, 0.1, 0.15})), 0.9 * box) << "control: a lower box";
}

}  // namespace
}  // namespace truestep::mpm
