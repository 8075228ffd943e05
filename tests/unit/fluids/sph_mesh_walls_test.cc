// Walls of triangles: what a kernel has behind them, where water may start, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/kernels/sph/smoothing.h"
#include "engine/systems/sph/walls.h"
#include "tests/unit/fluids/mesh_collider_rig.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::box_collider;
using testing_rig::box_of_triangles;
using testing_rig::SphRun;

const Vec3 kDown{0, -9.81, 0};

/// A room of a metre with these colliders and a little water under its ceiling.
SphDef room_with(AnyColliderDefs colliders) {
  SphDef d;
  d.spacing = 0.05, d.precision = Precision::f64;
  d.bodies = {{.center = {0.5, 0.9, 0.5}, .half_extents = {0.1, 0.1, 0.1}}};
  d.colliders = std::move(colliders);
  return d;
}

/// At a place: what is behind walls, its gradient and the effect of weight.
struct Walled {
  double share = 0, drive = 0;
  Vec3 slope, lean;
};
Walled walled(const SphDef& d, const Vec3& x, double t = 0) {
  const auto set = settle(d, "s", {});
  const BoxWalls<3, double> walls(*set);
  Fluid<3, double> f;
  f.resize(1);
  f.x[0][0] = x.x, f.x[1][0] = x.y, f.x[2][0] = x.z;
  walls.shares(f, t, ThreadArena(1));
  const double place[3] = {x.x, x.y, x.z};
  return {f.wall[3], f.drive[0], {f.wall[0], f.wall[1], f.wall[2]}, walls.lean(place, kDown, f.wall[3], t)};
}

// In front of a face that is flat as far as a kernel reaches, a mesh is the box: to 1 %, where the map, whose
// nodes are half a spacing apart, is interpolated and leaves out what is below a thousandth.
TEST(SphMeshWalls, AFaceIsThatOfABox) {
  const Vec3 center{0.5, 0.3, 0.5}, half{0.3, 0.1, 0.3};
  const SphDef box = room_with({box_collider(center, half)});
  const SphDef mesh = room_with({box_of_triangles(center, half)});
  for (const double d : {0.013, 0.025, 0.05, 0.08}) {
    for (const double aside : {0.0, 0.061}) {
      const Vec3 x{0.5 + aside, 0.4 + d, 0.5};
      const Walled a = walled(box, x), b = walled(mesh, x);
      EXPECT_NEAR(b.share, a.share, 0.01 * a.share + 1e-6) << d;
      EXPECT_NEAR(norm(b.slope - a.slope), 0, 0.01 * norm(a.slope) + 1e-6) << d;
      EXPECT_NEAR(norm(b.lean - a.lean), 0, 0.01 * norm(a.lean) + 1e-6) << d;
    }
  }
  EXPECT_EQ(walled(mesh, {0.5, 0.51, 0.5}).share, 0) << "beyond the kernel";
  // The control: a lower mesh.
  const SphDef lower = room_with({box_of_triangles(center, {0.3, 0.08, 0.3})});
  EXPECT_LT(walled(lower, {0.5, 0.425, 0.5}).share, 0.8 * walled(box, {0.5, 0.425, 0.5}).share);
}

/// m/s^2, of walls that stand, on liquid at a place that moves along z at 1 m/s.
double held(SphDef d, const Vec3& x) {
  d.walls = Walls::no_slip, d.viscosity = 1;
  const auto set = settle(d, "s", {});
  const double place[3] = {x.x, x.y, x.z};
  return -BoxWalls<3, double>(*set).drag(place, {0, 0, 1}, 0).z;
}

// A wall holds liquid by as much of it as a kernel reaches: at an edge half of what a face does, to what the
// map's cells miss there (below), in a corner more. A ball that fell in a tube was held by flat faces all
// round.
TEST(SphMeshWalls, HoldByAsMuchAsIsThere) {
  const Vec3 center{0.5, 0.3, 0.5}, half{0.3, 0.1, 0.3};
  const SphDef mesh = room_with({box_of_triangles(center, half)});
  for (const double d : {0.025, 0.05}) {
    const double flat = held(mesh, {0.5, 0.4 + d, 0.5});
    EXPECT_NEAR(flat, held(room_with({box_collider(center, half)}), {0.5, 0.4 + d, 0.5}), 0.01 * flat) << d;
    EXPECT_NEAR(held(mesh, {0.8, 0.4 + d, 0.5}), 0.5 * flat, 0.13 * flat) << d;
  }
  EXPECT_GT(held(mesh, {0.5, 0.425, 0.5}), 1.5 * held(mesh, {0.5, 0.45, 0.5}))
      << "control: farther off, less";
}

/// The same in a corner of a container whose sides are the coordinate planes, by a sum over small cells.
Walled summed(const SphDef& d, const Vec3& x) {
  constexpr int kHalf = 40;
  const double support = d.support * d.spacing, width = support / kHalf;
  const auto middle = [&](int k) { return (k + 0.5) * width; };
  Walled out;
  double all = 0;
  for (int i = -kHalf; i < kHalf; ++i) {
    for (int j = -kHalf; j < kHalf; ++j) {
      for (int k = -kHalf; k < kHalf; ++k) {
        const Vec3 r{middle(i), middle(j), middle(k)};
        const double q = norm(r) / support;
        if (q >= 1) continue;
        const auto at = smoothing_at(d.kernel, q);
        all += at.w[0];
        if (x.x + r.x > 0 && x.y + r.y > 0 && x.z + r.z > 0) continue;
        const Vec3 g = r * (-at.s[0] / (support * support));
        out.share += at.w[0], out.slope += g, out.lean += -(g * dot(r, kDown)) + kDown * at.w[0];
      }
    }
  }
  return {out.share / all, 0, out.slope / all, out.lean / all};
}

// A corner of a container: edges and the corner itself, against the integrals over what is behind them. The
// map is a sum over cells half a spacing wide; it counts half of those in whose middle the edge or corner
// lies, of which three quarters or seven eighths are wall: 0.014 of a kernel at an edge and 0.034 in a
// corner, a thirteenth and an eighth of the gradient. The system counts less behind a face than the integral
// does (a lattice in front of it is at rest); so the integrals are taken in terms of the nearest face.
TEST(SphMeshWalls, ACornerOfAContainerHoldsWhatIsBehindIt) {
  MeshColliderDef tank = box_of_triangles({0.5, 0.5, 0.5}, {0.3, 0.3, 0.3});
  tank.container = true;
  SphDef mesh = room_with({tank});
  mesh.bodies[0].center = {0.5, 0.5, 0.5};
  double single = 0;
  for (const Vec3 off : {Vec3{0.025, 0.3, 0.3}, Vec3{0.025, 0.025, 0.3}, Vec3{0.025, 0.075, 0.3},
                         Vec3{0.025, 0.025, 0.025}, Vec3{0.075, 0.025, 0.025}}) {
    const double nearest = std::min({off.x, off.y, off.z});
    const Walled face = walled(mesh, {0.2 + nearest, 0.5, 0.5}), flat = summed(mesh, {nearest, 1, 1});
    Walled exact = summed(mesh, off);
    exact.share *= face.share / flat.share;
    const double steep = norm(face.slope) / norm(flat.slope);
    exact.slope = exact.slope * steep, exact.lean = exact.lean * steep;
    const Walled got = walled(mesh, Vec3{0.2, 0.2, 0.2} + off);
    EXPECT_NEAR(got.share, exact.share, 0.04) << off.x << ' ' << off.y << ' ' << off.z;
    EXPECT_NEAR(norm(got.slope - exact.slope), 0, 0.13 * norm(exact.slope))
        << off.x << ' ' << off.y << ' ' << off.z;
    EXPECT_NEAR(norm(got.lean - exact.lean), 0, 0.02 * 9.81) << off.x << ' ' << off.y << ' ' << off.z;
    if (off.z == 0.025) single = std::max(single, exact.share - face.share);
  }
  EXPECT_GT(single, 0.2) << "control: the nearest face alone";
}

TEST(SphMeshWalls, AMovingMeshDrivesTheDensity) {
  MeshColliderDef mesh = box_of_triangles({0.5, 0.3, 0.5}, {0.3, 0.1, 0.3});
  BoxColliderDef box = box_collider({0.5, 0.3, 0.5}, {0.3, 0.1, 0.3});
  MotionDef motion;
  motion.velocity = {0, 0.2, 0}, motion.amplitude = {0, 0.01, 0}, motion.frequency = 2,
  motion.spin = {0, 1, 0};
  mesh.motion = box.motion = motion;
  for (const double t : {0.0, 0.3}) {
    const SphDef a = room_with({box}), b = room_with({mesh});
    const double top =
        moved({{0.5, 0.3, 0.5}, {}}, {{0, 0.2, 0}, {0, 0.01, 0}, 2, 0, {}}, t).position.y + 0.1;
    const Vec3 x{0.6, top + 0.025, 0.5};
    // The set's velocities are means over a tenth of a millisecond.
    const Walled of_box = walled(a, x, t), of_mesh = walled(b, x, t);
    EXPECT_NEAR(of_mesh.drive, of_box.drive, 0.01 * std::abs(of_box.drive)) << t;
    EXPECT_GT(std::abs(of_box.drive), 0.5) << "control: it does";
  }
}

TEST(SphMeshWalls, WaterDoesNotStartInThem) {
  // Of a body that fills the room up to a half, what is above ground that is a quarter high on average.
  HeightFieldColliderDef ground;
  ground.count = {2, 2}, ground.spacing = 1, ground.heights = {0, 0.5, 0, 0.5}, ground.center = {0.5, 0, 0.5};
  SphDef d = room_with({ground});
  d.bodies = {{.center = {0.5, 0.25, 0.5}, .half_extents = {0.5, 0.25, 0.5}}};
  const SphRun run(d);
  const size_t all = 20 * 20 * 10;
  EXPECT_NEAR(static_cast<double>(run.system.setting().rows), 0.5 * all, 0.03 * all);
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 p = run.position(i);
    EXPECT_GT((p.y - 0.5 * p.x) / std::sqrt(1.25), -1e-9);
  }
  // A container as large as the room leaves nothing out; a solid in the middle its volume.
  MeshColliderDef tank = box_of_triangles({0.5, 0.5, 0.5}, {0.5, 0.5, 0.5});
  tank.container = true;
  d.colliders = {tank};
  EXPECT_EQ(SphRun(d).system.setting().rows, all);
  d.colliders = {box_of_triangles({0.5, 0.25, 0.5}, {0.3, 0.2, 0.3})};
  EXPECT_EQ(SphRun(d).system.setting().rows, all - 12 * 12 * 8);
}

using Told = std::vector<std::string>;
Told told(const SphDef& d) {
  Told out;
  sph_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

TEST(SphMeshWalls, WhatDoesNotFitIsRefused) {
  const MeshColliderDef good = box_of_triangles({0.5, 0.3, 0.5}, {0.3, 0.1, 0.3});
  EXPECT_EQ(told(room_with({good})), Told{}) << "control";
  SphDef plane = room_with({PlaneColliderDef{}, good});
  plane.dimension = 2;
  EXPECT_EQ(told(plane), Told{"/colliders/1/type"});
  // Moving, it may come from anywhere; at rest only what is in the room counts.
  MeshColliderDef vast = box_of_triangles({0.5, -40, 0.5}, {40, 40.1, 40});
  EXPECT_EQ(told(room_with({vast})), Told{});
  vast.motion = MotionDef{};
  vast.motion->velocity = {0, 0.1, 0};
  EXPECT_EQ(told(room_with({vast})), Told{"/colliders/0"});
}

}  // namespace
}  // namespace truestep::sph
