// Implicit methods on trees of links: any stiffness of joints is solved, in a time that grows with the number
// of links.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/base/thread_clock.h"
#include "engine/core/equations/force_system.h"
#include "engine/core/equations/linear_solver.h"
#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/articulation/articulation.h"
#include "tests/support/patience.h"

namespace truestep {
using namespace articulation;
namespace {

struct Links {
  Links(const ArticulationDef& def, const std::string& method, double dt) : h(dt) {
    ArticulationDef d = def;
    d.integrator = method;
    BuildContext context{.id = "a"};
    context.dt = dt;
    system = build_articulation(&d, context);
    state = system->initial_state();
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k, ++done) {
      system->step(state,
                   {.t = h * double(done), .h = h, .step = done, .workspace = workspace, .arena = arena});
    }
  }
  double energy() const {
    Observables out;
    system->observe(state, 0, out);
    return out.find("energy.total").value();
  }

  double h;
  std::unique_ptr<const System> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t done = 0;
};

// Links of 0.1 m and 0.1 kg in a row, springs relaxed at the start, 1.2 rad from hanging.
ArticulationDef chain(int links, double stiffness, JointType joint = JointType::revolute) {
  ArticulationDef d;
  for (int i = 0; i < links; ++i) {
    LinkDef l;
    l.joint = joint, l.mass = 0.1, l.center = {0, -0.1, 0}, l.stiffness = stiffness;
    if (i > 0) l.offset = {0, -0.1, 0};
    if (joint == JointType::spherical) {
      l.inertia = {1e-4, 1e-4, 1e-4};
      l.q =
          i == 0 ? std::vector<double>{std::cos(0.6), 0, 0, std::sin(0.6)} : std::vector<double>{1, 0, 0, 0};
      if (i == 0) l.stiffness = 0;
    } else if (i == 0) {
      l.q = {1.2}, l.rest = 1.2;
    }
    d.links.push_back(l);
  }
  return d;
}

// Rounding of torques of 1e6 N m on inertias of 1e-3 kg m^2 far exceeds what a residual may leave: what
// counts is the motion that it corresponds to.
TEST(StiffLinks, ImplicitMethodsSolveJointsOfAnyStiffness) {
  for (const char* method : {"implicit_euler", "trapezoid", "bdf2", "newmark"}) {
    for (const double k : {1e4, 1e6, 1e8, 1e10}) {
      Links run(chain(10, k), method, 1.0 / 60);
      const double start = run.energy();
      ASSERT_NO_THROW(run.steps(120)) << method << ' ' << k;
      EXPECT_LE(run.energy(), start + 1e-6) << method << ' ' << k;
      // A cantilever of 1 m and 1 kg on such springs gives way by 1 N m / k, whatever has been damped.
      EXPECT_GE(run.energy(), start - 50 / k) << method << ' ' << k;
    }
  }
}

TEST(StiffLinks, BallsHoldAsHingesDo) {
  for (const double k : {1e4, 1e8}) {
    // Free at the first joint, it swings down as a single rod of 1 m.
    Links run(chain(10, k, JointType::spherical), "trapezoid", 1.0 / 60);
    const double start = run.energy();
    ASSERT_NO_THROW(run.steps(300)) << k;
    EXPECT_NEAR(run.energy(), start, 1e-2 * std::abs(start)) << k;
  }
}

/// What the n-th step of implicit Euler evaluates and solves; a chain of free joints falls.
Statistics work_of_step(int links, int n) {
  const articulation::ArticulationField field(articulation::build_model(chain(links, 0)), {0, -9.81, 0});
  State state = field.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const double h = 1.0 / 60;
  Statistics count;
  for (int k = 0; k < n; ++k) {
    const StepInput in{.t = h * k, .h = h, .workspace = workspace, .arena = arena};
    Motion motion(field, state, in);
    const FieldEquations f(motion);
    std::vector<double> y(motion.x.begin(), motion.x.end());
    y.insert(y.end(), motion.v.begin(), motion.v.end());
    Carry carry;
    Advance step{
        .f = f, .t = h * k, .t_end = h * (k + 1), .y = y.data(), .workspace = workspace, .carry = carry};
    step.statistics = &count, count = {};
    find_integrator("implicit_euler")->advance(step);
    std::copy_n(y.begin(), motion.x.size(), motion.x.begin());
    std::copy_n(y.begin() + static_cast<ptrdiff_t>(motion.x.size()), motion.v.size(), motion.v.begin());
  }
  return count;
}

TEST(StiffLinks, AStepTakesTimeInProportionToTheLinks) {
  // The same number of evaluations and solves for ten times the links ...
  const Statistics few = work_of_step(100, 3), many = work_of_step(1000, 3);
  std::printf("rates %d, %d; factorisations %d, %d; solves %d, %d\n", int(few.rates), int(many.rates),
              int(few.factorisations), int(many.factorisations), int(few.solves), int(many.solves));
  EXPECT_LE(many.rates, 2 * few.rates);
  EXPECT_LE(many.factorisations, 2 * few.factorisations);
  EXPECT_LE(many.solves, 2 * few.solves);
  // ... each in linear time: 0.4 s for two steps. A dense matrix of 40,000 unknowns has 13 GB.
  const double begin = thread_cpu_seconds();
  ArticulationDef longest = chain(20'000, 0);
  for (LinkDef& l : longest.links) l.inertia = {0.1, 0.1, 0.1};
  Links run(longest, "implicit_euler", 1.0 / 60);
  run.steps(2);
  std::printf("%.2f s\n", thread_cpu_seconds() - begin);
  EXPECT_LT(thread_cpu_seconds() - begin, std::chrono::duration<double>(patience(10)).count());
}

// The control: loops are not solved in that way yet, but by dense matrices.
TEST(StiffLinks, LoopsStillTakeADenseMatrix) {
  ArticulationDef d = chain(3, 0);
  d.links[2].id = "last";
  d.closures.push_back({.a = "last", .point_a = {0, -0.1, 0}});
  d.closures[0].point_b = {0.28, -0.1, 0};
  const articulation::ArticulationField field(articulation::build_model(d), {0, -9.81, 0});
  EXPECT_FALSE(field.linear_solver());
  d.closures.clear();
  EXPECT_TRUE(articulation::ArticulationField(articulation::build_model(d), {0, -9.81, 0}).linear_solver());
}

}  // namespace
}  // namespace truestep
