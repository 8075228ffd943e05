// Solids at periodic sides: what reaches through a side goes on at the other, so that a flow past it is the
// same wherever the sides are. Solids once ended at such a side.
#include <algorithm>
#include <cstdio>

#include "tests/unit/fluids/mesh_collider_rig.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

constexpr double kWide = 0.6, kSpacing = 0.03;
enum class At : uint8_t { middle, side };

double place_of(At at) {
  return at == At::middle ? 0.5 * kWide : 0;
}

/// Liquid that fills a box without sides, as two halves along x in the order of their distance from the
/// solid, with a hole around it.
SphDef around(At at, Method solver, int dimension, const Vec3& hole) {
  SphDef d;
  d.dimension = dimension, d.spacing = kSpacing, d.solver = solver, d.precision = Precision::f64, d.xsph = 0;
  d.high = {kWide, kWide, kWide}, d.periodic = dimension == 2 ? Periodic::xy : Periodic::xyz;
  const double half = 0.5 * kWide;
  for (const double x : {0.25, 0.75}) {
    const double place = std::fmod(x * kWide + place_of(at) + half, kWide);
    d.bodies.push_back({.center = {place, half, half}, .half_extents = {0.5 * half, half, half}});
    d.bodies.back().velocity = {0.4, 0.1, 0};
  }
  for (const double x : {place_of(at), place_of(at) + kWide})
    d.hollows.push_back({.center = {x, half, half}, .half_extents = hole});
  return d;
}

struct Difference {
  double most = 0, way = 0;  ///< m or m/s, between two flows half a box apart; m/s, of what the solid did
};
Difference compare(SphDef middle, SphDef side, uint64_t steps) {
  SphRun one(middle, 0.002), two(side, 0.002);
  EXPECT_EQ(one.system.setting().rows, two.system.setting().rows);
  one.step(steps), two.step(steps);
  Difference out;
  for (size_t i = 0; i < std::min(one.system.setting().rows, two.system.setting().rows); ++i) {
    const Vec3 off = one.position(i) - two.position(i);
    out.most = std::max({out.most, std::abs(std::remainder(off.x - 0.5 * kWide, kWide)),
                         std::abs(std::remainder(off.y, kWide)), std::abs(std::remainder(off.z, kWide)),
                         norm(one.velocity(i) - two.velocity(i))});
    out.way = std::max(out.way, norm(one.velocity(i) - Vec3{0.4, 0.1, 0}));
  }
  return out;
}

// Only rounding differs, by 1e-16 at the start, and grows with the particles' disorder.
constexpr double kRounding = 1e-8;

TEST(SphImages, FlowPastACylinderOnASideIsThatInTheMiddle) {
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    const auto flow = [&](At at, bool solid) {
      SphDef d = around(at, solver, 2, {0.1, 0.1, 1});
      d.walls = Walls::no_slip, d.viscosity = 1e-3;
      SphereColliderDef cylinder;
      cylinder.center = {solid ? place_of(at) : 0.31, 0.5 * kWide, 0}, cylinder.radius = 0.08;
      d.colliders = {cylinder};
      return d;
    };
    const Difference same = compare(flow(At::middle, true), flow(At::side, true), 20);
    std::printf("  solver %d: %.1e, deflected by %.2f m/s\n", static_cast<int>(solver), same.most, same.way);
    EXPECT_LT(same.most, kRounding);
    EXPECT_GT(same.way, 0.1) << "control: the cylinder deflects it";
    const Difference ended = compare(flow(At::middle, true), flow(At::side, false), 20);
    EXPECT_GT(ended.most, 1e-3) << "control: without an image of it at the other side";
  }
}

// A tilted box on an edge of the box, and a box of triangles that moves through a side.
TEST(SphImages, BoxesAndMeshesAreRepeatedInSpace) {
  for (const bool mesh : {false, true}) {
    const auto flow = [&](At at) {
      SphDef d = around(at, Method::dfsph, 3, {0.08, 0.08, 0.08});
      const Vec3 center{place_of(at), 0.5 * kWide, 0.5 * kWide}, half{0.07, 0.05, 0.05};
      if (mesh) {
        MeshColliderDef c = testing_rig::box_of_triangles(center, half);
        c.motion = MotionDef{.velocity = {-0.5, 0, 0}};
        d.colliders = {c};
      } else {
        BoxColliderDef c;
        c.center = center, c.half_extents = half, c.axis = {1, 2, 3}, c.angle = 0.4;
        d.colliders = {c};
      }
      return d;
    };
    const Difference same = compare(flow(At::middle), flow(At::side), 10);
    std::printf("  %s: %.1e, deflected by %.2f m/s\n", mesh ? "mesh" : "box", same.most, same.way);
    EXPECT_LT(same.most, kRounding);
    EXPECT_GT(same.way, 0.05) << "control: it is deflected";
  }
}

TEST(SphImages, ABodyOnASideFeelsTheLiquidOnBothSides) {
  const Solid solid = box_solid({0.06, 0.06, 0.06});
  const auto drifting = [&](At at, double beyond) {
    SphDef d = around(at, Method::dfsph, 3, {0.061, 0.061, 0.061});
    SphRun run(d, 0.002);
    ImmersedBody body{.solid = &solid, .mass = 0.8, .place = {place_of(at) + beyond, 0.3, 0.3}};
    body.moments = {2e-3, 2e-3, 2e-3};
    for (int k = 0; k < 10; ++k) run.step(1, {&body, 1});
    return body;
  };
  const ImmersedBody middle = drifting(At::middle, 0), side = drifting(At::side, 0),
                     far = drifting(At::side, -3 * kWide);
  std::printf("  impulse %.6f, on the side %.6f N s\n", middle.impulse.x, side.impulse.x);
  EXPECT_LT(norm(side.impulse - middle.impulse), kRounding);
  EXPECT_LT(norm(side.twist - middle.twist), kRounding);
  EXPECT_LT(norm(far.impulse - middle.impulse), kRounding) << "wherever it has drifted to";
  EXPECT_GT(norm(middle.impulse), 0.01) << "control: the liquid carries it along";
}

// A rail along a periodic axis reaches through both sides: it is one solid, not several in the same place.
TEST(SphImages, WhatReachesThroughBothSidesGoesOnByItself) {
  SphDef d = around(At::middle, Method::dfsph, 3, {1, 0.1, 0.1});
  const MeshColliderDef rail = testing_rig::box_of_triangles({0.3, 0.3, 0.3}, {0.5, 0.08, 0.08});
  d.colliders = {rail};
  const SphRun run(d);
  const Images images = run.system.setting().meshes[0].images;
  EXPECT_EQ(images.period[0], 0);
  EXPECT_EQ(images.period[1], kWide);
  EXPECT_EQ(images.period[2], kWide);
}

// Liquid starts outside of a mesh's images too, and pictures show those of solids at rest.
TEST(SphImages, LeaveLiquidOutAtTheStartAndAreDrawn) {
  const auto rows = [](At at) {
    SphDef d = around(at, Method::dfsph, 3, {0.001, 0.001, 0.001});
    d.hollows.clear();
    MeshColliderDef c = testing_rig::box_of_triangles({place_of(at), 0.31, 0.31}, {0.1, 0.1, 0.1});
    d.colliders = {c};
    const SphRun run(d);
    Drawing out;
    run.system.draw(run.state, 0, Wish::obstacles, out);
    return std::pair{run.system.setting().rows, out.obstacles.size()};
  };
  EXPECT_EQ(rows(At::middle).first, rows(At::side).first);
  EXPECT_LT(rows(At::middle).first, 8000u) << "control: a full box";
  EXPECT_EQ(rows(At::middle).second, 1u);
  EXPECT_EQ(rows(At::side).second, 2u);
}

}  // namespace
}  // namespace truestep::sph
