// A body whose solid is a closed surface of triangles used to end a run in its first step with "a sphere's
// radius must be positive", because the sweep of fast bodies asked for the core of a surface, which has none.
#include <gtest/gtest.h>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
namespace {

TEST(MovingMesh, FallsOntoABox) {
  rigid3d::MeshBodyDef mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  mesh.position = {0, 1, 0};
  rigid3d::Rigid3dDef d;
  rigid3d::BoxBodyDef floor = testing::box({3, 0.5, 3}, {0, -0.5, 0});
  floor.motion = rigid3d::BodyDef::Motion::fixed;
  d.bodies = {floor, mesh};
  testing::RigidRun run(d, 0.01);
  run.seconds(2);
  // It lies on one of its faces, whose middle is nearer to the centre of mass than the middle of its height
  // is.
  EXPECT_GT(run.x(1).y, 0);
  EXPECT_LT(run.x(1).y, 0.5);
  EXPECT_LT(norm(run.v(1)), 0.1);
}

}  // namespace
}  // namespace truestep
