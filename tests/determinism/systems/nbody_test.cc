// Bodies give the same bits on any number of threads, without a workspace, and from a copy of a state.
#include "tests/support/runs/nbody_run.h"

namespace truestep::nbody {
namespace {

using testing_rig::model_units;
using testing_rig::NbodyRun;

NbodyDef cluster(Method method) {
  NbodyDef d = model_units();
  d.groups = {PlummerDef{.count = 3000}};
  d.softening = 0.02, d.method = method;
  if (method == Method::tree) d.radius = 0.004, d.collisions = CollisionsDef{};
  return d;
}

TEST(NbodyDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Method method : {Method::direct, Method::tree, Method::fmm}) {
    NbodyRun one(cluster(method), 0.01, 1), four(cluster(method), 0.01, 4), other(cluster(method), 0.0101, 1);
    one.step(5), four.step(5), other.step(5);
    EXPECT_EQ(one.state.hash(), four.state.hash());
    EXPECT_NE(one.state.hash(), other.state.hash());
  }
}

TEST(NbodyDeterminism, AStateIsAllThatAStepNeeds) {
  for (const Method method : {Method::direct, Method::tree, Method::fmm}) {
    NbodyRun run(cluster(method), 0.01), copy(cluster(method), 0.01);
    run.step(5);
    copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
    for (int k = 0; k < 5; ++k) {
      run.workspace.clear();
      run.step(), copy.step();
    }
    EXPECT_EQ(run.state.hash(), copy.state.hash());
    if (method == Method::tree) {
      EXPECT_GT(run.observe("collisions"), 0);
    }
  }
}

TEST(NbodyDeterminism, EncountersTakeNothingOver) {
  NbodyDef d = model_units();
  d.positions = {{0, 0, 0}}, d.masses = {1};
  d.groups = {OrbitDef{.mass = 1e-4}, OrbitDef{.mass = 1e-4, .semi_major_axis = 1.05, .mean_anomaly = 0.2}};
  d.integrator = "mercurius";
  NbodyRun run(d, 0.1), copy(d, 0.1), other(d, 0.101);
  run.step(60), copy.step(30), other.step(60);
  copy.state = State::deserialize(copy.state.serialize()), copy.workspace.clear();
  copy.step(30);
  EXPECT_EQ(run.state.hash(), copy.state.hash());
  EXPECT_NE(run.state.hash(), other.state.hash());
}

TEST(NbodyDeterminism, BlockTimeStepsTakeNothingOver) {
  NbodyDef d = model_units();
  d.groups = {PlummerDef{.count = 300}};
  d.softening = 1e-3, d.integrator = "hermite";
  NbodyRun one(d, 0.05, 1), four(d, 0.05, 4), other(d, 0.051, 1), copy(d, 0.05);
  one.step(4), four.step(4), other.step(4);
  EXPECT_EQ(one.state.hash(), four.state.hash());
  EXPECT_NE(one.state.hash(), other.state.hash());
  copy.step(2);
  copy.state = State::deserialize(copy.state.serialize()), copy.workspace.clear();
  copy.step(2);
  EXPECT_EQ(one.state.hash(), copy.state.hash());
}

}  // namespace
}  // namespace truestep::nbody
