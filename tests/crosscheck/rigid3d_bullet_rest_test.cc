// What rests in rigid3d compared with Bullet 3.24 (double): heights of stacks and of single bodies, and the
// same statistics of heaps, whose motion is chaotic.
#include <gtest/gtest.h>

#include "tests/support/runs/engine_run.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

TEST(Bullet, AStackOfBoxesStandsAtTheSameHeight) {
  Rigid3dDef d;
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->count = {1, 8, 1}, b.position.y = 0.5;
  d.bodies = {ground(), b};
  EngineRun x = ours(d), y = theirs(d);
  x.seconds(5), y.seconds(5);
  for (size_t i = 1; i < x.count(); ++i) {
    // Both let a contact sink by a few millimetres.
    EXPECT_NEAR(x.x(i).y, y.x(i).y, 0.005 * static_cast<double>(i)) << i;
    EXPECT_LT(std::hypot(y.x(i).x, y.x(i).z), 0.02) << i;
  }
  // Control: a shorter box is seen.
  EXPECT_GT(std::abs(x.x(8).y - 0.95 * y.x(8).y), 0.005 * 8);
}

enum class Filling : uint8_t { boxes, balls };

/// 64 bodies dropped between four walls.
Rigid3dDef heap_scene(Filling filling, double size, double friction, double shift = 0) {
  Rigid3dDef d;
  d.bodies = {ground()}, d.friction = friction;
  for (const double side : {-1.0, 1.0}) {
    for (const bool along_x : {true, false}) {
      BoxBodyDef wall = box(along_x ? Vec3{0.5, 5, 3} : Vec3{3, 5, 0.5},
                            along_x ? Vec3{2 * side, 5, 0} : Vec3{0, 5, 2 * side});
      wall.motion = BodyDef::Motion::fixed;
      d.bodies.push_back(wall);
    }
  }
  CopiesDef many;
  many.count = {4, 4, 4}, many.spacing = {0.7, 1.6, 0.7};
  many.jitter = 0.1, many.turn = CopiesDef::Turn::random;
  BoxBodyDef boxes = box({0.25 * size, 0.2 * size, 0.3 * size}, {shift, 1, 0});
  SphereBodyDef balls = ball(0.28 * size, {shift, 1, 0});
  boxes.copies = balls.copies = many;
  if (filling == Filling::boxes) {
    d.bodies.push_back(boxes);
  } else {
    d.bodies.push_back(balls);
  }
  return d;
}

struct Heap {
  double height = 0, kinetic = 0, penetration = 0;
};
Heap heap(EngineRun r) {
  r.seconds(6);
  double height = 0;
  for (size_t i = 5; i < r.count(); ++i) height += r.x(i).y / 64;
  return {height, r.observed("energy.kinetic"), r.observed("penetration")};
}

TEST(Bullet, HeapsWithoutFrictionSettleToTheSameStatistics) {
  for (const Filling f : {Filling::boxes, Filling::balls}) {
    // Each engine draws its own random numbers, and heaps of 64 scatter by some 2 %: the mean of six runs.
    Heap a, b;
    for (const double shift : {0.0, 0.01, 0.02, 0.03, 0.04, 0.05}) {
      const Heap x = heap(ours(heap_scene(f, 1, 0, shift))), y = heap(theirs(heap_scene(f, 1, 0, shift)));
      a.height += x.height / 6, b.height += y.height / 6;
      a.kinetic = std::max(a.kinetic, x.kinetic), b.kinetic = std::max(b.kinetic, y.kinetic);
      a.penetration = std::max(a.penetration, x.penetration);
    }
    // Bullet's boxes overlap slightly and keep settling for many seconds; balls reach the same height.
    EXPECT_NEAR(a.height, b.height, (f == Filling::balls ? 0.04 : 0.12) * a.height);
    // The fall released 150 kJ; frictionless boxes keep sliding slowly.
    EXPECT_LT(a.kinetic, 1500);
    EXPECT_LT(b.kinetic, 1500);
    // A body that still slides at half a metre per second moves 8 mm per step, and may be that deep before it
    // is pushed out; Bullet's boxes overlap by up to a decimetre where they are wedged in.
    EXPECT_LT(a.penetration, 0.025);
    // Control: bodies larger by a tenth have a third more volume.
    EXPECT_GT(heap(theirs(heap_scene(f, 1.1, 0))).height, 1.15 * b.height);
  }
}

TEST(Bullet, WithFrictionItsHeapsNearOursAsStepsShrink) {
  // With ten iterations per step friction creeps, so that Bullet's heaps are denser; less so with shorter
  // steps.
  const auto looser = [](double h) {
    return heap(ours(heap_scene(Filling::balls, 1, 0.5), h)).height /
           heap(theirs(heap_scene(Filling::balls, 1, 0.5), h)).height;
  };
  const double coarse = looser(1.0 / 60), fine = looser(1.0 / 480);
  EXPECT_LT(fine, 1.12);
  EXPECT_GT(coarse, fine);
}

TEST(Bullet, EveryShapeRestsAtItsHeight) {
  Rigid3dDef d;
  CapsuleBodyDef capsule;
  capsule.position = {4, 0.3, 0}, capsule.axis = {0, 0, 1}, capsule.angle = M_PI / 2;
  CylinderBodyDef cylinder;
  cylinder.position = {6, 0.6, 0};
  HullBodyDef hull;
  hull.position = {8, 0.1, 0};
  hull.points = {{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0, 0, 0.6}, {0, 1, 0}};
  CompoundBodyDef compound;
  compound.position = {10, 0.6, 0};
  BoxPartDef left, right;
  left.position = {-0.5, 0, 0}, right.position = {0.5, 0, 0};
  left.half_extents = right.half_extents = {0.3, 0.5, 0.4};
  compound.parts = {left, right};
  d.bodies = {ground(), ball(0.5, {0, 0.55, 0}), box({0.5, 0.3, 0.4}, {2, 0.35, 0}), capsule, cylinder, hull,
              compound};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(3), b.seconds(3);
  for (size_t i = 1; i < a.count(); ++i) {
    EXPECT_NEAR(a.x(i).y, b.x(i).y, 0.005) << i;
    EXPECT_LT(norm(b.v(i)), 0.01) << i;
  }
}

TEST(Bullet, MeshesAndHeightFieldsCarry) {
  Rigid3dDef d;
  MeshBodyDef mesh;
  mesh.motion = BodyDef::Motion::fixed;
  mesh.vertices = {{-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3}};
  mesh.triangles = {0, 2, 1, 0, 3, 2};
  HeightFieldBodyDef field;
  field.motion = BodyDef::Motion::fixed, field.position = {10, 0, 0};
  field.count = {3, 3}, field.spacing = 2, field.heights.assign(9, 0.25);
  d.bodies = {mesh, field, ball(0.5, {0.3, 0.6, 0.2}), ball(0.5, {10.2, 0.9, 0.3})};
  EngineRun b = theirs(d);
  b.seconds(2);
  EXPECT_NEAR(b.x(2).y, 0.5, 0.01);
  EXPECT_NEAR(b.x(3).y, 0.75, 0.01);
}

TEST(Bullet, RepeatsToTheBit) {
  const Rigid3dDef d = heap_scene(Filling::boxes, 1, 0.5);
  EngineRun a = theirs(d), b = theirs(d);
  a.seconds(1), b.seconds(1);
  EXPECT_EQ(a.state.hash(), b.state.hash());
}

}  // namespace
}  // namespace truestep::testing
