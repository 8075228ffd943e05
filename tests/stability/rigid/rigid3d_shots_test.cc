// Fast bodies against thin walls and against each other: shots at 50 to 300 m/s pass through nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::ball;
using testing::box;
using testing::RigidRun;

constexpr double kReach = 0.12;  // m, of the largest shot

AnyBodyDef projectile(double choice) {
  if (choice < 0.25) return ball(0.1, {});
  if (choice < 0.45) return box({0.1, 0.03, 0.05}, {});
  if (choice < 0.65) {
    CapsuleBodyDef d;
    d.radius = 0.02, d.half_length = 0.1;
    return d;
  }
  if (choice < 0.85) {
    CylinderBodyDef d;
    d.radius = 0.08, d.half_length = 0.02;
    return d;
  }
  HullBodyDef d;
  d.points = {{0.1, 0, 0}, {-0.05, 0.08, 0}, {-0.05, -0.04, 0.07}, {-0.05, -0.04, -0.07}};
  return d;
}

struct Count {
  int through = 0;  ///< came out behind the wall
  int jumps = 0;    ///< would never have touched it if checked once a step
};

/// Shots of 1 to 5 m a step at a wall of 1 cm that leans by up to half a radian.
Count shoot(int shots) {
  Count count;
  for (int k = 0; k < shots; ++k) {
    const auto n = static_cast<uint64_t>(k);
    const auto u = uniform4(11, 1, n), v = uniform4(11, 2, n), w = uniform4(11, 3, n);
    Rigid3dDef d;
    BoxBodyDef wall = box({0.005, 4, 4}, {});
    wall.motion = BodyDef::Motion::fixed;
    wall.axis = {0, u[0] - 0.5, u[1] - 0.5}, wall.angle = 0.5 * u[2];
    d.bodies.push_back(wall);
    AnyBodyDef shot = projectile(v[0]);
    std::visit(
        [&](BodyDef& b) {
          b.position = {-3 - 5 * v[1], 2 * v[2] - 1, 2 * v[3] - 1};
          b.velocity = {50 + 250 * w[0], 4 * w[1] - 2, 4 * w[2] - 2};
          b.axis = {w[1] - 0.5, w[2] - 0.5, w[3] - 0.5}, b.angle = 6 * u[3];
          b.angular_velocity = Vec3{w[3] - 0.5, u[3] - 0.5, v[3] - 0.5} * 60.0;
        },
        shot);
    d.bodies.push_back(shot);
    RigidRun run(d, 1.0 / 60, 1, {});
    const Vec3 normal = rotation(run.q(0)).apply({1, 0, 0}), from = run.x(1), move = run.v(1) * run.h;
    bool touched = false;
    for (int s = 0; s < 12; ++s) touched |= std::abs(dot(normal, from + move * s)) < kReach + 0.005;
    count.jumps += !touched;
    bool through = false;
    for (int s = 0; s < 12; ++s) {
      run.run(1);
      const double depth = dot(normal, run.x(1));
      // A shot that slides off over the wall's rim did not pass through it.
      through |= depth > 0 && norm(run.x(1) - normal * depth) < 3.8;
    }
    count.through += through;
  }
  return count;
}

TEST(Rigid3dStability, NoShotPassesAThinWall) {
  const Count count = shoot(8000);
  EXPECT_EQ(count.through, 0);
  // The control: without a check between the steps most would be behind the wall.
  EXPECT_GT(count.jumps, 4000);
}

TEST(Rigid3dStability, NoShotPassesATriangleMesh) {
  // A curtain of triangles without any thickness, shot at from its front.
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
  constexpr int kCells = 8;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      vertices.push_back({0.05 * std::sin(1.0 * i + j), i - 0.5 * kCells, j - 0.5 * kCells});
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const int64_t a = j * (kCells + 1) + i;
      for (const int64_t v : {a, a + 1, a + kCells + 2, a, a + kCells + 2, a + kCells + 1})
        triangles.push_back(v);
    }
  }
  MeshBodyDef mesh;
  mesh.vertices = vertices, mesh.triangles = triangles, mesh.motion = BodyDef::Motion::fixed;
  int through = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto u = uniform4(13, 1, static_cast<uint64_t>(k)), v = uniform4(13, 2, static_cast<uint64_t>(k));
    Rigid3dDef d;
    d.bodies.push_back(mesh);
    AnyBodyDef shot = projectile(v[0]);
    std::visit(
        [&](BodyDef& b) {
          b.position = {2 + 4 * u[0], 4 * u[1] - 2, 4 * u[2] - 2};
          b.velocity = {-50 - 250 * v[1], 4 * v[2] - 2, 4 * v[3] - 2};
          b.axis = {1, u[3], -1}, b.angle = 6 * u[1];
        },
        shot);
    d.bodies.push_back(shot);
    RigidRun run(d, 1.0 / 60, 1, {});
    run.run(10);
    through += run.x(1).x < -kReach;
  }
  EXPECT_EQ(through, 0);
}

TEST(Rigid3dStability, NoShotPassesWhatMoves) {
  // Shot and shield fly towards each other; the shield rotates.
  int through = 0;
  for (int k = 0; k < 1500; ++k) {
    const auto u = uniform4(17, 1, static_cast<uint64_t>(k)), v = uniform4(17, 2, static_cast<uint64_t>(k));
    Rigid3dDef d;
    BoxBodyDef shield = box({0.02, 3, 3}, {});
    shield.mass = 1000, shield.velocity = {-20 * u[0], 0, 0}, shield.angular_velocity = {3 * u[1], 0, 0};
    d.bodies.push_back(shield);
    AnyBodyDef shot = projectile(v[0]);
    std::visit(
        [&](BodyDef& b) {
          b.mass = 0.1;
          b.position = {-3 - 5 * u[2], 2 * u[3] - 1, 2 * v[1] - 1};
          b.velocity = {50 + 250 * v[2], 2 * v[3] - 1, 0};
        },
        shot);
    d.bodies.push_back(shot);
    RigidRun run(d, 1.0 / 60, 1, {});
    run.run(12);
    through += dot(rotation(run.q(0)).apply({1, 0, 0}), run.x(1) - run.x(0)) > kReach;
  }
  EXPECT_EQ(through, 0);
}

}  // namespace
}  // namespace truestep
