// Flocks give the same bits on any number of threads, without a workspace, and from a copy of a state.
#include "tests/unit/particles/flocking_rig.h"

namespace truestep::flocking {
namespace {

using testing_rig::FlockRun;

FlockingDef flock(Rule rule) {
  FlockingDef d;
  d.rule = rule, d.count = 1500, d.sides = rule == Rule::vicsek ? Sides::periodic : Sides::open;
  d.predators = rule == Rule::reynolds ? 1 : 0;
  SphereColliderDef ball;
  ball.radius = 1;
  d.colliders = {ball};
  return d;
}
constexpr Rule kRules[] = {Rule::reynolds, Rule::vicsek, Rule::cucker_smale};

TEST(FlockingDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Rule rule : kRules) {
    FlockRun one(flock(rule), 0.05, 1), four(flock(rule), 0.05, 4), other(flock(rule), 0.051, 1);
    one.step(10), four.step(10), other.step(10);
    EXPECT_EQ(one.state.hash(), four.state.hash());
    EXPECT_NE(one.state.hash(), other.state.hash());
  }
}

TEST(FlockingDeterminism, AStateIsAllThatAStepNeeds) {
  for (const Rule rule : kRules) {
    FlockRun run(flock(rule), 0.05), copy(flock(rule), 0.05);
    run.step(5);
    copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
    for (int k = 0; k < 5; ++k) {
      run.workspace.clear();
      run.step(), copy.step();
    }
    EXPECT_EQ(run.state.hash(), copy.state.hash());
  }
}

}  // namespace
}  // namespace truestep::flocking
