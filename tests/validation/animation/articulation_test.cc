// Trees of links against conservation laws, closed forms and the orders of the integrator rows.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "tests/validation/animation/articulation_trees.h"

namespace truestep::test {
using namespace articulation;
namespace {

using articulation::Work;

constexpr double kQuarterTurn = std::numbers::pi / 2;

/// A trunk with branches of every kind of joint; floating freely when `root` says so.
ArticulationDef shrub(JointType root) {
  ArticulationDef d;
  const auto add = [&](JointType joint, const char* id, const char* parent, Vec3 offset) -> LinkDef& {
    LinkDef l;
    l.joint = joint, l.id = id, l.offset = offset, l.density = 500;
    if (*parent) l.parent = parent;
    BoxLinkDef box;
    box.half_extents = {0.1, 0.3, 0.05}, box.position = {0.05, -0.3, 0.1}, box.rotation = {0.2, 0.1, 0.5};
    l.shapes.push_back(box);
    d.links.push_back(l);
    return d.links.back();
  };
  add(root, "trunk", "ground", {});
  if (root == JointType::free) {
    d.links[0].q = {0, 0, 0, 1, 0, 0, 0}, d.links[0].v = {0.3, -0.2, 0.1, 0.4, 0.5, -0.6};
  }
  add(JointType::spherical, "arm", "trunk", {0.1, -0.6, 0}).v = {1, 2, -1};
  add(JointType::universal, "hand", "arm", {0, -0.6, 0}).v = {2, -1};
  add(JointType::cylindrical, "leg", "trunk", {-0.1, -0.6, 0}).v = {0.2, 3};
  add(JointType::fixed, "foot", "leg", {0, -0.6, 0}).rotation = {0, 0.5, 1};
  add(JointType::prismatic, "toe", "foot", {0, -0.6, 0}).stiffness = 300;
  d.links[1].stiffness = 20, d.links[2].stiffness = 10, d.links[3].stiffness = 400;
  return d;
}

TEST(Articulation, AFloatingTreeKeepsItsMomentaAndItsEnergy) {
  const ArticulationDef d = shrub(JointType::free);
  const auto observed = [](const System& s, const State& state, const char* name) {
    Observables out;
    s.observe(state, 0, out);
    return *out.find(name);
  };
  BuildContext context;
  context.gravity = {};
  ArticulationDef with = d;
  with.integrator = "dop853", with.tolerance = 1e-12;
  const auto system = build_articulation(&with, context);
  State state = system->initial_state();
  const char* const kKept[] = {"energy.total",       "momentum.x",         "momentum.y",        "momentum.z",
                               "angular_momentum.x", "angular_momentum.y", "angular_momentum.z"};
  std::vector<double> before;
  for (const char* name : kKept) before.push_back(observed(*system, state, name));
  Workspace workspace;
  const ThreadArena arena(1);
  for (uint64_t k = 0; k < 300; ++k) system->step(state, {double(k) * 0.01, 0.01, k, workspace, arena});
  for (size_t i = 0; i < std::size(kKept); ++i) {
    EXPECT_NEAR(observed(*system, state, kKept[i]), before[i], 1e-8) << kKept[i];
  }
  // An impulse adds to the momentum, wherever it hits.
  const double px = observed(*system, state, "momentum.x"), pz = observed(*system, state, "momentum.z");
  Command hit;
  hit.kind = CommandKind::impulse, hit.index = 2, hit.vector = {3, 0, -1};
  system->apply(state, hit);
  EXPECT_NEAR(observed(*system, state, "momentum.x"), px + 3, 1e-9);
  EXPECT_NEAR(observed(*system, state, "momentum.z"), pz - 1, 1e-9);
}

TEST(Articulation, RowsHaveTheirOrder) {
  const auto field = field_of(shrub(JointType::revolute));
  const auto end = [&](const char* method, double h, double tolerance) {
    SteppedField run(field, *find_integrator(method), h, {.tolerance = tolerance});
    run.steps(static_cast<uint64_t>(std::lround(0.5 / h)));
    const auto x = run.state.f64(0);
    return std::vector<double>(x.begin(), x.end());
  };
  const auto exact = end("dop853", 1e-2, 1e-14);
  const auto error = [&](const char* method, double h) {
    const auto x = end(method, h, 1e300);
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - exact[i]));
    return worst;
  };
  EXPECT_NEAR(std::log2(error("rk4", 0.5 / 256) / error("rk4", 0.5 / 512)), 4, 0.15);
  EXPECT_NEAR(std::log2(error("dopri5", 0.5 / 128) / error("dopri5", 0.5 / 256)), 5, 0.3);
  // Every row that supports velocity-dependent forces ends at the same place.
  size_t served = 0;
  for (const Integrator& m : integrators()) {
    if (refusal(m, field)) continue;
    SteppedField run(field, m, 1e-3, {.tolerance = 1e-9});
    run.steps(500);
    double worst = 0;
    for (size_t i = 0; i < exact.size(); ++i)
      worst = std::max(worst, std::abs(run.state.f64(0)[i] - exact[i]));
    const int promised = m.order_with_velocity;
    // 1 ms at first order leaves some 1e-2 in motions of order 1; higher orders much less.
    EXPECT_LT(worst, promised == 1 ? 5e-2 : promised <= 3 ? 1e-3 : 1e-6) << m.name;
    ++served;
  }
  EXPECT_GT(served, 10u);
}

/// Rods of 1 m and 1 kg on balls, level at the start.
ArticulationDef level_chain(int64_t links) {
  ArticulationDef d;
  LinkDef l;
  BoxLinkDef rod;
  rod.half_extents = {0.5, 0.05, 0.05}, rod.position = {0.5, 0, 0};
  l.joint = JointType::spherical, l.mass = 1, l.shapes.push_back(rod);
  l.copies = LinkCopiesDef{links, {1, 0, 0}};
  d.links.push_back(l);
  return d;
}

TEST(Articulation, ALevelChainOfTenKeepsItsEnergyAtSixtyHertz) {
  const auto field = field_of(level_chain(10));
  // Fraction of the energy between the start and hanging straight (5 m on average) that is lost in ten
  // seconds.
  const auto drift = [&](const char* method, double h, double tolerance) {
    SteppedField run(field, *find_integrator(method), h, {.tolerance = tolerance, .relative_tolerance = 0});
    const double before = run.energy();
    run.steps(static_cast<uint64_t>(std::lround(10 / h)));
    return std::abs(run.energy() - before) / (9.81 * 50);
  };
  // Peers that maintain joints by corrections lose a third to a half at 60 Hz.
  EXPECT_LT(drift("dop853", 1.0 / 60, 1e-6), 1e-6);
  EXPECT_LT(drift("dopri5", 1.0 / 60, 1e-6), 1e-4);
  EXPECT_LT(drift("rk4", 1.0 / 480, 0), 1e-3);
  // Control: rk4 with a step of a 60th loses more than that.
  EXPECT_GT(drift("rk4", 1.0 / 60, 0), 1e-3);
}

TEST(Articulation, AChainOfTwoThousandWithAHeavyEndKeepsItsEnergy) {
  // Links of 0.1 m and 1 kg carry 10 t: transverse waves of sqrt(T / (m l)) = 1000/s and twice that at most,
  // so that rk4 takes half a millisecond.
  ArticulationDef d;
  LinkDef l;
  l.mass = 1, l.center = {0, -0.05, 0}, l.inertia = {1e-3, 1e-5, 1e-3}, l.joint = JointType::revolute;
  l.rotation = {0, 0, 0.02};
  l.copies = LinkCopiesDef{1999, {0, -0.1, 0}};
  d.links.push_back(l);
  LinkDef end = l;
  end.mass = 1e4, end.copies.reset(), end.offset = {0, -0.1, 0}, end.rotation = {},
  end.inertia = {10, 10, 10};
  d.links.push_back(end);
  const auto field = field_of(d);
  ASSERT_EQ(field.model().links.size(), 2000u);
  const auto run_for = [&](double h, int steps) {
    SteppedField run(field, *find_integrator("rk4"), h);
    Evaluation e{run.workspace, run.arena};
    const double before = run.energy();
    run.steps(static_cast<uint64_t>(steps));
    const Phase at{0, run.state.f64(0), run.state.f64(1), run.state};
    const double kinetic = field.kinetic(at, e);
    // Links are as far from one another as they were, whatever the forces.
    double gap = 0;
    const auto& m = field.model();
    const Work work = field.placed(run.state);
    std::vector<spatial::Frame> frames(work.size());
    world_frames(m.tree, work, frames);
    for (size_t i = 1; i < frames.size(); ++i)
      gap = std::max(gap, std::abs(norm(frames[i].p - frames[i - 1].p) - 0.1));
    return std::array<double, 3>{std::abs(run.energy() - before), kinetic, gap};
  };
  const auto [lost, kinetic, gap] = run_for(5e-4, 600);
  std::printf("2000 links: energy error %.3g J of %.3g J kinetic, gap %.3g m\n", lost, kinetic, gap);
  EXPECT_GT(kinetic, 10);
  EXPECT_LT(lost, 1e-3 * kinetic);
  EXPECT_LT(gap, 1e-12);
  // Control: ten times the step is beyond rk4's stability interval.
  const double unstable = run_for(5e-3, 60)[0];
  EXPECT_FALSE(unstable < 1e-3 * kinetic);
}

TEST(Articulation, SoftLimitsHoldAndKeepEnergy) {
  const auto bounce = [](double limit_damping) {
    ArticulationDef d = pendulum(1, kQuarterTurn);
    d.links[0].lowest = -0.5, d.links[0].limit_stiffness = 1e4, d.links[0].limit_damping = limit_damping;
    const auto field = field_of(d);
    SteppedField run(field, *find_integrator("rk4"), 1e-4);
    const double before = run.energy();
    double lowest = 0;
    for (int k = 0; k < 30000; ++k) run.steps(1), lowest = std::min(lowest, run.x());
    return std::pair(lowest, run.energy() - before);
  };
  const auto [lowest, gained] = bounce(0);
  // 9.81 cos(0.5) J of fall into 1/2 k s^2: s = 0.0415 at most.
  EXPECT_LT(lowest, -0.54);
  EXPECT_GT(lowest, -0.542);
  // The force has a kink at the limit, which a fixed step passes with an error of k v^2 h^2 each time.
  EXPECT_NEAR(gained, 0, 2e-4);
  // A damper beyond the limit removes energy.
  EXPECT_LT(bounce(20).second, -1);
}

TEST(Articulation, DrivesAndDampersBalance) {
  // A free hinge without gravity ends at torque / damping; on a ball a spring balances the torque 2 k w x.
  ArticulationDef d = pendulum(1, 0);
  d.links[0].torque = {3}, d.links[0].damping = 2;
  const auto hinge = field_of(d, {});
  SteppedField run(hinge, *find_integrator("rk4"), 1e-2);
  run.steps(2000);
  EXPECT_NEAR(run.v(), 1.5, 1e-12);
  ArticulationDef ball = top(1, {0, 0, 0.1}, {1, 1, 1}, {});
  ball.links[0].torque = {2, 0, 0}, ball.links[0].stiffness = 4, ball.links[0].damping = 3;
  const auto held = field_of(ball, {});
  SteppedField turned(held, *find_integrator("rk4"), 1e-2);
  turned.steps(5000);
  // 2 k sin(a/2) cos(a/2) = k sin a = 2.
  EXPECT_NEAR(2 * std::atan2(turned.x(1), turned.x(0)), std::asin(0.5), 1e-9);
}

TEST(Articulation, RefusesJointsThatMoveNothing) {
  ArticulationDef d = pendulum(2, 0);
  d.links[1].center = {};
  try {
    field_of(d);
    FAIL() << "a point on its own axis has no inertia";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "scene_invalid");
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/links/1");
  }
}

}  // namespace
}  // namespace truestep::test
