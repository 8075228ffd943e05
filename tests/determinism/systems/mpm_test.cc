// The material point method gives the same bits on any number of threads, with and without a workspace, and
// from a copy of a state.
#include <gtest/gtest.h>

#include "engine/geometry/solid.h"
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

MpmDef mixture(int dimension, Precision precision) {
  MpmDef d;
  d.dimension = dimension, d.precision = precision, d.cell = dimension == 2 ? 0.02 : 0.05;
  double at = 0.15;
  for (const Law law : {Law::fluid, Law::corotated, Law::snow, Law::sand, Law::foam}) {
    BodyDef b;
    b.center = {at, 0.3, 0.5}, b.half_extents = {0.1, 0.2, 0.3}, b.material = law;
    b.velocity = {0.5 - at, -1, 0};
    d.bodies.push_back(b);
    at += 0.17;
  }
  return d;
}

TEST(MpmDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const int dimension : {2, 3}) {
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      const MpmDef d = mixture(dimension, precision);
      MpmRun one(d, 1.0 / 60, {0, -9.81, 0}, 1), two(d, 1.0 / 60, {0, -9.81, 0}, 2);
      one.step(3), two.step(3);
      EXPECT_EQ(one.state.hash(), two.state.hash());
      MpmRun other(d, 1.0 / 60, {0, -9.8, 0}, 1);
      other.step(3);
      EXPECT_NE(one.state.hash(), other.state.hash());
    }
  }
}

TEST(MpmDeterminism, AStateIsAllThatAStepNeeds) {
  const MpmDef d = mixture(2, Precision::f32);
  MpmRun run(d, 1.0 / 60, {0, -9.81, 0}), copy(d, 1.0 / 60, {0, -9.81, 0});
  run.step(3);
  copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
  for (int k = 0; k < 3; ++k) {
    run.workspace.clear();
    run.step(), copy.step();
  }
  EXPECT_EQ(run.state.hash(), copy.state.hash());
}

// Pieces of the mixture in three velocity fields.
TEST(MpmDeterminism, FieldsThatMeetAreTheSameOnAnyNumberOfThreadsAndFromACopy) {
  for (const int dimension : {2, 3}) {
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      MpmDef d = mixture(dimension, precision);
      int field = 0;
      for (BodyDef& b : d.bodies) b.velocity_field = field++ % 3;
      MpmRun one(d, 1.0 / 60, {0, -9.81, 0}, 1), two(d, 1.0 / 60, {0, -9.81, 0}, 2);
      one.step(), two.step();
      EXPECT_EQ(one.state.hash(), two.state.hash());
      if (dimension == 3 && precision == Precision::f32) continue;
      MpmRun copy(d, 1.0 / 60, {0, -9.81, 0});
      copy.state = State::deserialize(one.state.serialize()), copy.steps = one.steps;
      one.workspace.clear();
      one.step(), copy.step();
      EXPECT_EQ(one.state.hash(), copy.state.hash());
      MpmRun single(mixture(dimension, precision), 1.0 / 60, {0, -9.81, 0});
      single.step(2);
      EXPECT_NE(single.state.hash(), one.state.hash()) << "control: they meet";
    }
  }
}

// Newton's method and conjugate gradients over blocks of nodes: sums in a fixed order.
TEST(MpmDeterminism, ImplicitStepsAreTheSameOnAnyNumberOfThreadsAndFromACopy) {
  for (const int dimension : {2, 3}) {
    MpmDef d;
    d.dimension = dimension, d.precision = Precision::f64, d.cell = dimension == 2 ? 0.05 : 0.1;
    d.integration = Integration::implicit_steps;
    BodyDef b;
    b.center = {0.3, 0.3, 0.5}, b.half_extents = {0.2, 0.25, 0.2}, b.youngs_modulus = 1e7,
    b.velocity = {1, -2, 0};
    d.bodies = {b, b};
    d.bodies[1].center.x = 0.75, d.bodies[1].material = Law::neo_hookean;
    MpmRun one(d, 1.0 / 60, {0, -9.81, 0}, 1), two(d, 1.0 / 60, {0, -9.81, 0}, 2);
    one.step(2), two.step(2);
    EXPECT_EQ(one.state.hash(), two.state.hash());
    MpmRun copy(d, 1.0 / 60, {0, -9.81, 0});
    copy.state = State::deserialize(one.state.serialize()), copy.steps = one.steps;
    one.workspace.clear();
    one.step(2), copy.step(2);
    EXPECT_EQ(one.state.hash(), copy.state.hash());
    EXPECT_NE(one.state.hash(), two.state.hash()) << "control: it moves";
  }
}

TEST(MpmDeterminism, BodiesInTheMaterialAreTheSameOnAnyNumberOfThreads) {
  const Solid ball = sphere_solid(0.12);
  MpmDef d = mixture(3, Precision::f32);
  const auto run_with = [&](int threads, double place) {
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 5, bodies[0].moments = Vec3{1, 1, 1} * 0.03;
    bodies[0].place = {place, 0.6, 0.5}, bodies[0].velocity = {0, -3, 0};
    MpmRun run(d, 1.0 / 60, {0, -9.81, 0}, threads);
    run.step(3, bodies);
    return std::pair{run.state.hash(), bodies[0].impulse.y};
  };
  const auto one = run_with(1, 0.4), two = run_with(2, 0.4), other = run_with(1, 0.41);
  EXPECT_EQ(one, two);
  EXPECT_NE(one.first, other.first) << "control";
  EXPECT_GT(one.second, 0) << "control: it is held up";
}

}  // namespace
}  // namespace truestep::mpm
