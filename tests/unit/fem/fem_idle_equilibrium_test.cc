// Quasi-static steps in which nothing had changed used to factorise a matrix each, for a correction that they
// then did not apply: nine tenths of the time of a study in space.
#include "engine/integrators/implicit/newton/stage_newton.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

FemDef hung_block() {
  FemDef d;
  d.block = SoftBlockShape{.cells_x = 3, .cells_y = 2, .cells_z = 2};
  d.youngs_modulus = 1e5, d.density = 100, d.pinned = {"x0"}, d.motion = Motion::quasi_static;
  return d;
}

/// Linear systems solved in the next step. Without the workspace: a step depends on the state alone.
int solutions(FemRun& run) {
  run.workspace = Workspace();
  run.step();
  return run.workspace.object<NewtonReport>(kNewtonReport).solves;
}

TEST(FemIdleEquilibrium, AStepThatBringsNothingSolvesNothing) {
  FemRun run(hung_block(), 0.1, {0, -9.81, 0});
  EXPECT_GT(solutions(run), 0);
  const std::vector<double> at(run.state.f64(FemColumns::position).begin(),
                               run.state.f64(FemColumns::position).end());
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(solutions(run), 0);
    for (size_t i = 0; i < at.size(); ++i) {
      EXPECT_EQ(run.state.f64(FemColumns::position)[i], at[i]);
      EXPECT_EQ(run.state.f64(FemColumns::velocity)[i], 0);
    }
  }
}

// Controls: any change of the forces is answered, however small.
TEST(FemIdleEquilibrium, WhateverChangesIsAnswered) {
  FemRun run(hung_block(), 0.1, {0, -9.81, 0});
  solutions(run);
  EXPECT_EQ(solutions(run), 0);
  const auto tip = int64_t(run.node_at({1, 1, 1}));
  const double before = run.displacement(size_t(tip)).y;
  run.system->apply(run.state,
                    {.kind = CommandKind::push, .index = tip, .vector = {0, 1e-3, 0}, .duration = 0.05});
  EXPECT_GT(solutions(run), 0);
  EXPECT_GT(run.displacement(size_t(tip)).y, before);
  EXPECT_GT(solutions(run), 0);  // the push is over
  // Newton's corrections end at a millionth of the push's displacement, which was itself a millionth.
  EXPECT_NEAR(run.displacement(size_t(tip)).y, before, 1e-9);
  run.system->apply(run.state,
                    {.kind = CommandKind::set_parameter, .value = 1.001e5, .name = "youngs_modulus"});
  EXPECT_GT(solutions(run), 0);
}

// It used to look for an equilibrium of nothing and to fail after 256 parts of a step.
TEST(FemIdleEquilibrium, ABodyThatIsHeldEverywhereGoesWhereItIsTold) {
  FemDef d = hung_block();
  d.pinned = {};
  d.sets = {{.name = "all"}};
  d.holds = {{.on = "all", .x = "0.1*X*t", .y = "0", .z = "0"}};
  FemRun run(d, 0.1, {0, -9.81, 0});
  for (int k = 1; k <= 3; ++k) {
    EXPECT_EQ(solutions(run), 0);
    EXPECT_NEAR(run.displacement_at({1, 1, 1}).x, 0.01 * k, 1e-15) << k;
  }
  // Control: a component that is free has something to solve for, if something bears the weight.
  d.holds[0].y.reset();
  d.holds.push_back({.on = "x0", .y = "0"});
  FemRun some(d, 0.1, {0, -9.81, 0});
  EXPECT_GT(solutions(some), 0);
}

TEST(FemIdleEquilibrium, LoadsAndHoldsThatGrowAreFollowed) {
  FemDef d = hung_block();
  d.load_time = 0.35;
  FemRun grows(d, 0.1, {0, -9.81, 0});
  for (int k = 0; k < 4; ++k) EXPECT_GT(solutions(grows), 0) << k;
  EXPECT_EQ(solutions(grows), 0);
  d = hung_block();
  d.holds = {{.on = "x1", .x = "0.01*max(0,t-0.15)"}};
  FemRun held(d, 0.1, {0, -9.81, 0});
  EXPECT_GT(solutions(held), 0);
  EXPECT_GT(solutions(held), 0);
  EXPECT_NEAR(held.displacement_at({1, 1, 1}).x, 5e-4, 1e-15);
}

}  // namespace
}  // namespace truestep::fem
