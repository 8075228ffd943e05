// Dynamic bodies whose shape is a closed mesh: they used to fall through planes, and still do not collide
// with other meshes, which is reported before anything falls. Costs 0.1 s.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::box;
using testing::ground;
using testing::RigidRun;

// A box as a mesh of n x n squares a side, so that its faces have many vertices in one plane.
MeshBodyDef mesh_box(const Vec3& half, const Vec3& place, int n) {
  MeshBodyDef d;
  d.position = place;
  // Axis of the side, direction along it, and the two that span it, anticlockwise seen from outside.
  const int order[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  const double h[3] = {half.x, half.y, half.z};
  const auto vertex = [&](const double(&c)[3]) {
    const Vec3 v{c[0], c[1], c[2]};
    for (size_t k = 0; k < d.vertices.size(); ++k) {
      if (norm(d.vertices[k] - v) < 1e-9) return static_cast<int64_t>(k);
    }
    d.vertices.push_back(v);
    return static_cast<int64_t>(d.vertices.size() - 1);
  };
  for (const auto& o : order) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          int64_t id[4];
          for (int k = 0; k < 4; ++k) {
            double c[3];
            c[o[0]] = side * h[o[0]];
            c[o[1]] = h[o[1]] * (2.0 * (i + (k == 1 || k == 2)) / n - 1);
            c[o[2]] = h[o[2]] * (2.0 * (j + (k >= 2)) / n - 1);
            id[k] = vertex(c);
          }
          if (side < 0) std::swap(id[1], id[3]);
          for (const int k : {0, 1, 2, 0, 2, 3}) d.triangles.push_back(id[k]);
        }
      }
    }
  }
  return d;
}

TEST(Rigid3dMeshBody, FallsOnAPlaneAndStaysOnIt) {
  Rigid3dDef d;
  d.bodies.push_back(ground());
  d.bodies.push_back(mesh_box({0.3, 0.2, 0.4}, {0, 1, 0}, 6));
  d.bodies.push_back(box({0.3, 0.2, 0.4}, {3, 1, 0}));
  RigidRun run(d, 1.0 / 60);
  run.seconds(3);
  // Like a box that falls beside it; within what soft contacts give under its weight.
  EXPECT_NEAR(run.x(1).y, 0.2, 2e-3);
  EXPECT_NEAR(run.x(1).y, run.x(2).y, 1e-4);
  EXPECT_LT(norm(run.v(1)), 1e-3);
}

TEST(Rigid3dMeshBody, SlidesDownASlopeAsABoxDoes) {
  // contact.incline: mu = 0.3, 30 degrees, a = 2.3562872366 m/s^2.
  const double s = 0.5, c = std::sqrt(0.75);
  Rigid3dDef d;
  d.friction = 0.3;
  PlaneBodyDef slope;
  slope.normal = {s, c, 0}, slope.motion = BodyDef::Motion::fixed;
  d.bodies.push_back(slope);
  MeshBodyDef b = mesh_box({0.5, 0.1, 0.5}, Vec3{s, c, 0} * 0.1, 5);
  b.axis = {0, 0, 1}, b.angle = -std::asin(s);
  d.bodies.push_back(b);
  RigidRun run(d, 1.0 / 480);
  const Vec3 start = run.x(1);
  run.seconds(1);
  // As for the box, to a thousandth.
  EXPECT_NEAR(norm(run.x(1) - start), 1.178143618331198531, 1e-3 * 1.178);
}

TEST(Rigid3dMeshBody, RestsOnAFixedBoxAndCarriesABall) {
  Rigid3dDef d;
  BoxBodyDef table = box({1, 0.1, 1}, {0, -0.1, 0});
  table.motion = BodyDef::Motion::fixed;
  d.bodies.push_back(table);
  d.bodies.push_back(mesh_box({0.3, 0.2, 0.3}, {0, 0.25, 0}, 3));
  d.bodies.push_back(testing::ball(0.1, {0, 0.6, 0}));
  RigidRun run(d, 1.0 / 120);
  run.seconds(2);
  EXPECT_NEAR(run.x(1).y, 0.2, 3e-3);
  EXPECT_NEAR(run.x(2).y, 0.5, 5e-3);
}

TEST(Rigid3dMeshBody, OneThatWouldFallThroughAnotherSurfaceIsRefusedByName) {
  const auto code = [](const Rigid3dDef& d) -> std::string {
    try {
      RigidRun run(d, 1.0 / 60);
    } catch (const Error& e) {
      return e.issues().at(0).pointer + ' ' + e.issues().at(0).code;
    }
    return "";
  };
  Rigid3dDef d;
  HeightFieldBodyDef field;
  field.count = {2, 2}, field.spacing = 4, field.heights = {0, 0, 0, 0},
  field.motion = BodyDef::Motion::fixed;
  d.bodies.push_back(field);
  d.bodies.push_back(mesh_box({0.3, 0.2, 0.4}, {0, 1, 0}, 2));
  EXPECT_EQ(code(d), "/bodies/1 surfaces_do_not_meet");
  // Controls: groups that exclude the pair; an equivalent hull in place of the field.
  std::get<MeshBodyDef>(d.bodies[1]).mask = 2;
  EXPECT_EQ(code(d), "");
  d.bodies[0] = ground();
  std::get<MeshBodyDef>(d.bodies[1]).mask = 1;
  EXPECT_EQ(code(d), "");
  // Two of one kind would fall through each other.
  std::get<MeshBodyDef>(d.bodies[1]).copies = CopiesDef{};
  std::get<MeshBodyDef>(d.bodies[1]).copies->count = {2};
  EXPECT_EQ(code(d), "/bodies/1 surfaces_do_not_meet");
}

}  // namespace
}  // namespace truestep
