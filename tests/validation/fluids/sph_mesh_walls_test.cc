// Water in, on and in front of colliders of triangles, against the same water at boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/fluids/mesh_collider_rig.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::box_collider;
using testing_rig::box_of_triangles;
using testing_rig::SphRun;

const Vec3 kWeight{0, -9.81, 0};

struct Still {
  double height = 0, speed = 0, bottom = 0, compression = 0;  ///< m; m/s, rms; m, of the lowest; 1
};
Still still(const SphDef& d, double seconds) {
  SphRun run(d, 1.0 / 60, kWeight);
  run.seconds(seconds);
  return {run.observe("centre.y"), std::sqrt(2 * run.observe("energy.kinetic") / run.observe("mass")),
          run.observe("low.y"), run.observe("compression.mean")};
}

/// Water 0.2 m deep in a tank 0.4 m wide.
SphDef water_in_tank(Method solver) {
  SphDef d;
  d.solver = solver, d.spacing = 0.025;
  d.low = {-0.1, -0.1, -0.1}, d.high = {0.5, 0.5, 0.5};
  d.bodies = {{.center = {0.2, 0.1, 0.2}, .half_extents = {0.2, 0.1, 0.2}}};
  return d;
}

// At rest as in the system's own box: under 1 % of sqrt(g H), the bound of a pool (sph_test.cc), and at its
// height to a twentieth of a spacing, 0.6 % of the depth: what lies within a spacing of an edge is at most
// a sixth of the water, and is off by up to 4 % there (sph_mesh_walls_test.cc of the units).
TEST(SphMeshWalls, WaterRestsInATankOfTriangles) {
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    SphDef plain = water_in_tank(solver);
    plain.low = {0, 0, 0}, plain.high = {0.4, 0.4, 0.4};
    SphDef mesh = water_in_tank(solver);
    MeshColliderDef tank = box_of_triangles({0.2, 0.2, 0.2}, {0.2, 0.2, 0.2});
    tank.container = true;
    mesh.colliders = {tank};
    const Still a = still(plain, 2), b = still(mesh, 2);
    std::printf("%d: box %.5f m %.4f m/s %.2e, mesh %.5f m %.4f m/s %.2e\n", static_cast<int>(solver),
                a.height, a.speed, a.compression, b.height, b.speed, b.compression);
    EXPECT_LT(b.speed, 0.01 * std::sqrt(9.81 * 0.2)) << static_cast<int>(solver);
    EXPECT_NEAR(b.height, a.height, 0.05 * plain.spacing) << static_cast<int>(solver);
    EXPECT_GT(b.bottom, 0) << static_cast<int>(solver);
  }
  SphDef open = water_in_tank(Method::dfsph);
  open.colliders = {box_collider({0.2, -0.05, 0.2}, {0.2, 0.05, 0.2})};
  EXPECT_LT(still(open, 2).height, 0.08) << "control: a floor without sides";
}

// On the floor of the room: a box, the same as triangles, and as ground with 31 x 31 heights, all of which
// the water must not feel.
TEST(SphMeshWalls, WaterRestsOnFloorsOfTriangles) {
  SphDef d;
  d.spacing = 0.025, d.low = {0, -0.15, 0}, d.high = {0.4, 0.4, 0.4};
  d.bodies = {{.center = {0.2, 0.1, 0.2}, .half_extents = {0.2, 0.1, 0.2}}};
  const auto on = [&](const AnyColliderDef& floor) {
    SphDef with = d;
    with.colliders = {floor};
    return still(with, 2);
  };
  const Vec3 center{0.2, -0.15, 0.2}, half{0.4, 0.15, 0.4};
  HeightFieldColliderDef ground;
  ground.count = {31, 31}, ground.spacing = 0.4 / 30, ground.center = {0.2, 0, 0.2};
  ground.heights.assign(31 * 31, 0);
  const Still box = on(box_collider(center, half)), mesh = on(box_of_triangles(center, half)),
              field = on(ground);
  for (const Still& s : {mesh, field}) {
    EXPECT_LT(s.speed, 0.01 * std::sqrt(9.81 * 0.2));
    EXPECT_NEAR(s.height, box.height, 0.05 * d.spacing);
    EXPECT_GT(s.bottom, 0);
  }
  std::printf("box %.5f mesh %.5f field %.5f m, %.4f %.4f %.4f m/s\n", box.height, mesh.height, field.height,
              box.speed, mesh.speed, field.speed);
  EXPECT_LT(on(box_collider({0.2, -0.2, 0.2}, half)).height, box.height - 0.04) << "control: a lower floor";
}

// A slope of any steepness holds water at rest with a level surface: a basin of two slopes.
TEST(SphMeshWalls, WaterIsLevelInAValley) {
  SphDef d;
  d.spacing = 0.025, d.low = {0, 0, 0}, d.high = {0.6, 0.5, 0.2};
  d.bodies = {{.center = {0.3, 0.15, 0.1}, .half_extents = {0.3, 0.15, 0.1}}};
  HeightFieldColliderDef valley;
  valley.count = {3, 2}, valley.spacing = 0.3, valley.center = {0.3, 0.02, 0.1};
  valley.heights = {0.25, 0, 0.25, 0.25, 0, 0.25};
  d.colliders = {valley};
  SphRun run(d, 1.0 / 60, kWeight);
  run.seconds(3);
  const double speed = std::sqrt(2 * run.observe("energy.kinetic") / run.observe("mass"));
  EXPECT_LT(speed, 0.01 * std::sqrt(9.81 * 0.28));
  // The surface over the middle, and nearer to a side.
  double middle = 0, side = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 p = run.position(i);
    double& top = std::abs(p.x - 0.3) < 0.06 ? middle : side;
    if (std::abs(p.x - 0.3) < 0.06 || std::abs(p.x - 0.3) > 0.15) top = std::max(top, p.y);
    const double above = p.y - 0.02 - 0.25 / 0.3 * std::abs(p.x - 0.3);
    EXPECT_GT(above * std::cos(std::atan(0.25 / 0.3)), 0.2 * d.spacing);
  }
  std::printf("valley: %.4f m/s, %.4f and %.4f m\n", speed, middle, side);
  EXPECT_NEAR(middle, side, d.spacing);
  EXPECT_GT(middle, 0.2) << "control: the valley is full";
}

// A piston of triangles pushes water along a channel as a box does, and none gets past it.
TEST(SphMeshWalls, APistonOfTrianglesPushesWater) {
  SphDef d;
  d.spacing = 0.025, d.low = {0, 0, 0}, d.high = {0.8, 0.4, 0.2};
  d.bodies = {{.center = {0.5, 0.1, 0.1}, .half_extents = {0.3, 0.1, 0.1}}};
  MotionDef motion;
  motion.velocity = {0.3, 0, 0};
  const auto pushed = [&](auto piston) {
    piston.motion = motion;
    SphDef with = d;
    with.colliders = {piston};
    SphRun run(with, 1.0 / 60, kWeight);
    run.seconds(0.6);
    EXPECT_GT(run.observe("low.x"), 0.2 + 0.3 * 0.6);
    EXPECT_TRUE(std::isfinite(run.observe("energy.total")));
    return Vec3{run.observe("centre.x"), run.observe("centre.y"), run.observe("low.x")};
  };
  const Vec3 center{0.1, 0.2, 0.1}, half{0.1, 0.3, 0.3};
  const Vec3 box = pushed(box_collider(center, half)), mesh = pushed(box_of_triangles(center, half));
  std::printf("piston: box %.4f %.4f %.4f mesh %.4f %.4f %.4f\n", box.x, box.y, box.z, mesh.x, mesh.y,
              mesh.z);
  // A bore that breaks: centres within a quarter of a spacing.
  EXPECT_NEAR(mesh.x, box.x, 0.25 * d.spacing);
  EXPECT_NEAR(mesh.y, box.y, 0.25 * d.spacing);
  EXPECT_GT(mesh.x, 0.5 + 0.05) << "control: without the piston the centre stays at 0.5 m";
}

// Thrown at a turning mesh, nothing gets into it.
TEST(SphMeshWalls, NothingGetsIntoAMesh) {
  for (const Method solver : {Method::dfsph, Method::pbf}) {
    SphDef d;
    d.solver = solver, d.spacing = 0.04, d.high = {0.8, 0.8, 0.8};
    d.bodies = {{.center = {0.4, 0.62, 0.4}, .half_extents = {0.3, 0.16, 0.3}, .velocity = {0, -3, 0}}};
    MeshColliderDef paddle = box_of_triangles({0.4, 0.25, 0.4}, {0.3, 0.06, 0.2});
    paddle.motion = MotionDef{};
    paddle.motion->spin = {0, 2, 3};
    d.colliders = {paddle};
    SphRun run(d, 1.0 / 60, kWeight);
    const MeshWall& wall = run.system.setting().meshes[0];
    double deepest = HUGE_VAL, beside = 0;
    for (int k = 0; k < 60; ++k) {
      run.step();
      for (size_t i = 0; i < run.system.setting().rows; ++i) {
        const auto s = wall.surface(run.position(i), run.h * static_cast<double>(run.steps), d.spacing, 0.06);
        if (s) deepest = std::min(deepest, s->distance), ++beside;
      }
    }
    EXPECT_GT(deepest, 0) << static_cast<int>(solver);
    EXPECT_GT(beside, 1000) << "control: it is hit";
  }
}

}  // namespace
}  // namespace truestep::sph
