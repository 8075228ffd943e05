// The material point method comes out with the same bits on any number of threads, with and without a
// workspace, and from a copy of a state.
#include <gtest/gtest.h>

#include "tests/unit/mpm_rig.h"

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

}  // namespace
}  // namespace truestep::mpm
