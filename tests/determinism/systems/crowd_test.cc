// Crowds give the same bits on any number of threads, without a workspace, and from a copy of a state.
#include "tests/unit/particles/crowd_rig.h"

namespace truestep::crowd {
namespace {

using testing_rig::CrowdRun;

/// A crowd that leaves through a door, so that rows are removed while it runs.
CrowdDef throng(Model model) {
  CrowdDef d;
  d.model = model, d.noise = 0.1;
  d.walls = {{{{-5, -5, 0}, {0, -5, 0}, {0, 5, 0}, {-5, 5, 0}}, true}};
  d.doors = {{"exit", {0, 1, 0}, {0, -1, 0}}};
  d.groups.resize(2);
  for (GroupDef& g : d.groups) {
    g.count = 40, g.center = {-2.5, 0, 0}, g.half_extents = {2.2, 4.5, 0}, g.radius = 0.2,
    g.radius_deviation = 0.05;
    g.goal = {1, 0, 0}, g.leave = true, g.speed_deviation = 0.2;
  }
  return d;
}
CrowdDef corridor(Model model) {
  CrowdDef d;
  d.model = model, d.period = 20, d.noise = 0.2;
  d.groups.resize(2);
  for (GroupDef& g : d.groups) g.count = 100, g.half_extents = {10, 5, 0}, g.heading = {1, 0.2, 0};
  d.groups[1].heading = {-1, 0, 0};
  return d;
}

TEST(CrowdDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Model model : {Model::social_force, Model::orca}) {
    for (const CrowdDef& d : {throng(model), corridor(model)}) {
      CrowdRun one(d, 0.05, 1), four(d, 0.05, 4), other(d, 0.051, 1);
      one.step(60), four.step(60), other.step(60);
      EXPECT_EQ(one.state.hash(), four.state.hash());
      EXPECT_NE(one.state.hash(), other.state.hash());
    }
    EXPECT_LT(
        [&] {
          CrowdRun run(throng(model), 0.05);
          run.step(60);
          return run.people();
        }(),
        80u);
  }
}

TEST(CrowdDeterminism, AStateIsAllThatAStepNeeds) {
  for (const Model model : {Model::social_force, Model::orca}) {
    for (const CrowdDef& d : {throng(model), corridor(model)}) {
      CrowdRun run(d, 0.05), copy(d, 0.05);
      run.step(30);
      copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
      for (int k = 0; k < 30; ++k) {
        run.workspace.clear();
        run.step(), copy.step();
      }
      EXPECT_EQ(run.state.hash(), copy.state.hash());
    }
  }
}

}  // namespace
}  // namespace truestep::crowd
