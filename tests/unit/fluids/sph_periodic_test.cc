// Boxes that are periodic along every axis, initial velocities given as expressions, and particle shifting.
#include <algorithm>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

constexpr Method kSolvers[] = {Method::dfsph, Method::wcsph, Method::pbf};

/// A full box of a metre in the plane, or 0.6 m of it in space, without sides.
SphDef full_box(Method solver, int dimension, Precision precision = Precision::f64) {
  SphDef d;
  const double width = dimension == 3 ? 0.6 : 1;
  d.dimension = dimension, d.spacing = 0.05, d.solver = solver, d.precision = precision;
  d.high = {width, width, width}, d.xsph = 0;
  d.periodic = dimension == 3 ? Periodic::xyz : Periodic::xy;
  const Vec3 half = d.high * 0.5;
  d.bodies = {{.center = half, .half_extents = half}};
  return d;
}

/// Squares that overlap the side between `low` and `high` along y, given as one square in the middle or as
/// two halves at the sides.
SphDef patch(Method solver, bool across, int dimension) {
  SphDef d = full_box(solver, dimension);
  const double width = d.high.y;
  const Vec3 half{0.25 * width, 0.25 * width, 0.25 * width};
  const auto square = [&](double y, double height) {
    BodyDef b{.center = {0.5 * width, y, 0.5 * width}, .half_extents = {half.x, height, half.z}};
    b.velocity = {0, 1, 0};
    return b;
  };
  d.bodies = {square(0.375 * width, 0.125 * width), square(0.625 * width, 0.125 * width)};
  if (across) d.bodies = {square(0.875 * width, 0.125 * width), square(0.125 * width, 0.125 * width)};
  d.initial = {"0.3 * cos(4 * pi * y / " + std::to_string(width) + ")", "0"};
  if (dimension == 3) d.initial.push_back("0");
  return d;
}

// A square that lies across a side moves as one in the middle does: the initial velocity has half the box as
// its period, and only rounding differs.
TEST(SphPeriodic, ASideAlongAnyAxisIsNowhere) {
  for (const int dimension : {2, 3}) {
    for (const Method solver : kSolvers) {
      SphRun middle(patch(solver, false, dimension), 0.002), across(patch(solver, true, dimension), 0.002);
      const double width = middle.system.setting().def.high.y;
      const double start = middle.position(0).y;
      middle.step(20), across.step(20);
      double most = 0, way = 0;
      for (size_t i = 0; i < middle.system.setting().rows; ++i) {
        const Vec3 off = middle.position(i) - across.position(i);
        // Half a box apart, up to whole boxes.
        const double y = std::abs(std::remainder(off.y - 0.5 * width, width));
        most = std::max({most, std::abs(off.x), y, std::abs(off.z)});
        most = std::max(most, norm(middle.velocity(i) - across.velocity(i)));
        way = std::max(way, std::abs(middle.velocity(i).x));
      }
      EXPECT_LT(most, 1e-8) << dimension << ' ' << static_cast<int>(solver);
      EXPECT_GT(way, 0.1) << "control: it is sheared";
      EXPECT_GT(middle.position(0).y, start + 0.02) << "control: and moves";
    }
  }
}

// It passes through the side as often as its speed says, in both precisions. A cubic lattice does not stay
// one for ever: rounding grows, within 0.6 s to less than a hundredth of a spacing.
TEST(SphPeriodic, WhatLeavesReturnsOnTheOtherSide) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    for (const int dimension : {2, 3}) {
      SphDef d = full_box(Method::dfsph, dimension, precision);
      d.bodies[0].velocity = {0.3, -2, dimension == 3 ? 0.7 : 0};
      SphRun run(d, 0.01);
      const Vec3 start = run.position(5), v = d.bodies[0].velocity;
      run.seconds(0.6);
      const Vec3 way = run.position(5) - start;
      const Vec3 wide = d.high;
      const double near = 0.01 * d.spacing;
      EXPECT_NEAR(std::remainder(way.x - 0.6 * v.x, wide.x), 0, near);
      EXPECT_NEAR(std::remainder(way.y - 0.6 * v.y, wide.y), 0, near);
      EXPECT_NEAR(std::remainder(way.z - 0.6 * v.z, wide.z), 0, near);
      EXPECT_GT(std::abs(way.y - 0.6 * v.y), 0.5 * wide.y) << "control: it has crossed a side";
      EXPECT_NEAR(run.observe("momentum.y") / run.observe("mass"), -2, 1e-4);
    }
  }
}

// Velocities of bodies and of expressions add up, and the sound of wcsph is ten times the fastest.
TEST(SphInitial, IsAddedToThatOfTheBodies) {
  SphDef d = full_box(Method::wcsph, 2);
  d.bodies[0].velocity = {1, 0, 0};
  const double before = SphRun(d).system.setting().sound;
  d.initial = {"y", "2 * sin(pi * x)"};
  const SphRun run(d);
  double fastest = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 x = run.position(i), own{x.y, 2 * std::sin(3.14159265358979323846 * x.x), 0};
    EXPECT_NEAR(norm(run.velocity(i) - Vec3{1, 0, 0} - own), 0, 1e-12);
    fastest = std::max(fastest, norm(own));
  }
  EXPECT_NEAR(run.system.setting().sound, before + 10 * fastest, 1e-9);
}

/// Of a full box at 1 m/s that was shaken by a fifth of a spacing.
struct Shaken {
  double scatter, off;  ///< 1, of density, root mean square; m/s, of the velocity, the largest
};
Shaken shaken(SphDef d, double shifting, uint64_t steps) {
  d.bodies[0].velocity = {1, 0, 0}, d.shifting = shifting;
  d.kernel = Smoothing::wendland_c2, d.support = 3;
  SphRun run(d, 0.005);
  run.shake(0.01, 1);
  run.step(steps);
  const RealColumn<const double> density(run.state, columns::density);
  double sum = 0, squares = 0, off = 0;
  const double n = static_cast<double>(run.system.setting().rows);
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    sum += density.at(i), squares += density.at(i) * density.at(i);
    off = std::max(off, norm(run.velocity(i) - Vec3{1, 0, 0}));
  }
  return {std::sqrt(std::max(squares / n - sum * sum / (n * n), 0.0)), off};
}

// Shifting brings particles into order and leaves a uniform velocity as it is: nothing else moves them here.
TEST(SphShifting, OrdersParticlesWithoutMovingTheLiquid) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const SphDef d = full_box(Method::dfsph, 2, precision);
    const Shaken start = shaken(d, 2, 1), ordered = shaken(d, 2, 40), left = shaken(d, 0, 40);
    EXPECT_LT(ordered.scatter, 0.5 * start.scatter);
    EXPECT_LT(ordered.off, 1e-3);
    EXPECT_GT(left.scatter, 0.9 * start.scatter) << "control: unshifted";
  }
}

// Particles at a free surface stay, though grad C points out of it: a square that moves as one keeps its
// outline.
TEST(SphShifting, LeavesAFreeSurfaceAlone) {
  SphDef d = full_box(Method::wcsph, 2);
  d.bodies = {{.center = {0.5, 0.5, 0}, .half_extents = {0.25, 0.25, 1}, .velocity = {0, 1, 0}}};
  d.shifting = 4;
  SphRun run(d, 0.002);
  EXPECT_EQ(run.system.setting().closed, false);
  run.seconds(0.1);
  EXPECT_NEAR(run.observe("high.x") - run.observe("low.x"), 0.45, 0.01);
  EXPECT_NEAR(run.observe("high.y") - run.observe("low.y"), 0.45, 0.01);
}

// The same bits for any number of threads and from a snapshot.
TEST(SphPeriodic, GoesOnFromASnapshotWithTheSameBits) {
  for (const Method solver : kSolvers) {
    for (const int dimension : {2, 3}) {
      SphDef d = full_box(solver, dimension, Precision::f32);
      d.initial = {"sin(10 * y)", "cos(10 * x)"};
      if (dimension == 3) d.initial.push_back("0.1");
      SphRun one(d, 0.005, {}, 1), three(d, 0.005, {}, 3);
      one.step(10), three.step(10);
      EXPECT_EQ(one.state, three.state);
      SphRun again(d, 0.005, {}, 2);
      again.state = State::deserialize(one.state.serialize()), again.steps = one.steps;
      one.step(10), again.step(10);
      EXPECT_EQ(one.state, again.state);
    }
  }
}

// A nozzle works beside sides that let liquid through.
TEST(SphPeriodic, ANozzlePoursThroughASide) {
  SphDef d;
  d.dimension = 2, d.spacing = 0.05, d.periodic = Periodic::xy;
  InletDef e;
  e.position = {0.5, 0.7, 0}, e.radius = 0.15, e.speed = 2, e.stop = 0.2;
  d.emitters = {e};
  SphRun run(d, 1.0 / 60);
  run.seconds(0.45);
  // The last layer is born 0.4 m below the side at 0.175 s.
  EXPECT_EQ(run.observe("count"), 8.0 * 6);
  EXPECT_LT(run.observe("high.y"), 0.7);
  EXPECT_NEAR(run.observe("momentum.y") / run.observe("mass"), 2, 0.02);
}

}  // namespace
}  // namespace truestep::sph
