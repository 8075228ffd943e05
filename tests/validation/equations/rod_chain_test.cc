// Chains of rods: what each of the three treatments of constraints promises, and where it fails.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/systems/articulation/articulation.h"
#include "engine/systems/rod_chain/rod_chain.h"
#include "tests/support/runs/system_run.h"

namespace truestep {
using namespace articulation;
using namespace rod_chain;
namespace {

using Treatment = RodChainDef::Treatment;

constexpr double kG = 9.81;

struct RodRun : testing_rig::SystemRun<std::unique_ptr<const System>> {
  RodRun(const RodChainDef& d, double dt)
      : SystemRun([&] { return build_rod_chain(&d, BuildContext{.dt = dt}); }, dt) {}
  void seconds(double s) {
    for (auto k = std::llround(s / h); k > 0; --k) step(), gap = std::max(gap, observed("joints.gap"));
  }
  double observed(const char* name) const { return observe(name); }
  Vec3 x(size_t j) const { return load3(state.f64(0).data(), j); }

  double gap = 0;
};

RodChainDef chain(Treatment t, int64_t links = 10) {
  RodChainDef d;
  d.constraints = t, d.links = links, d.length = 0.15, d.mass = 0.1, d.direction = {1, -1, 0};
  return d;
}

TEST(RodChain, MultipliersAndProjectionLeaveAGapOfRounding) {
  // Positions of a metre are known to 1e-16; a handful of such roundings.
  for (const Treatment t : {Treatment::lagrange, Treatment::projection}) {
    RodRun r(chain(t), 1.0 / 240);
    r.seconds(5);
    EXPECT_LT(r.gap, 1e-13) << static_cast<int>(t);
  }
  // Control: springs do not.
  RodChainDef soft = chain(Treatment::penalty);
  soft.substeps = 8;
  RodRun r(soft, 1.0 / 240);
  r.seconds(1);
  EXPECT_GT(r.gap, 1e-5);
}

TEST(RodChain, SpringsGiveWayByForceOverStiffness) {
  for (const double k : {1e4, 1e5}) {
    RodChainDef d = chain(Treatment::penalty);
    d.direction = {0, -1, 0}, d.stiffness = k, d.damping = 20, d.substeps = 16;
    RodRun r(d, 1.0 / 240);
    r.seconds(4);
    const double weight = 10 * 0.1 * kG;
    EXPECT_NEAR(r.observed("joints.gap"), weight / k, 1e-3 * weight / k) << k;
  }
}

double energy_change(Treatment t, double h) {
  RodChainDef d = chain(t, 3);
  d.substeps = 1;  // without them multipliers choose their own steps
  RodRun r(d, h);
  const double before = r.observed("energy.total");
  r.seconds(1);
  return std::abs(r.observed("energy.total") - before);
}

TEST(RodChain, EnergyErrorsAreOfFourthAndFirstOrder) {
  const double fourth =
      energy_change(Treatment::lagrange, 1.0 / 120) / energy_change(Treatment::lagrange, 1.0 / 240);
  EXPECT_GT(std::log2(fourth), 3.7);
  const double first =
      energy_change(Treatment::projection, 1.0 / 480) / energy_change(Treatment::projection, 1.0 / 960);
  EXPECT_NEAR(std::log2(first), 1, 0.2);
  EXPECT_LT(energy_change(Treatment::lagrange, 1.0 / 240),
            1e-4 * energy_change(Treatment::projection, 1.0 / 240));
}

TEST(RodChain, FollowsTheSameChainInJointCoordinates) {
  // Thin rods on hinges in reduced coordinates, by an eighth-order method.
  ArticulationDef d;
  for (size_t i = 0; i < 5; ++i) {
    LinkDef l;
    l.mass = 0.1, l.center = {0, -0.075, 0}, l.q = {i == 0 ? M_PI / 4 : 0};
    const double inertia = 0.1 * 0.15 * 0.15 / 12;
    l.inertia = {inertia, 1e-3 * inertia, inertia};
    if (i > 0) l.offset = {0, -0.15, 0};
    d.links.push_back(l);
  }
  d.integrator = "dop853", d.tolerance = 1e-11;
  const auto system = build_articulation(&d, BuildContext{.dt = 1.0 / 240});
  State s = system->initial_state();
  Workspace workspace;
  ThreadArena arena{1};
  RodRun lagrange(chain(Treatment::lagrange, 5), 1.0 / 960),
      projection(chain(Treatment::projection, 5), 1.0 / 960);
  for (uint64_t k = 0; k < 240; ++k)
    system->step(s, {static_cast<double>(k) / 240, 1.0 / 240, k, workspace, arena});
  lagrange.seconds(1), projection.seconds(1);
  Observables seen;
  system->observe(s, 1, seen);
  // RK4 at 1 kHz on swings of a second.
  EXPECT_NEAR(seen.find("energy.kinetic").value(), lagrange.observed("energy.kinetic"), 1e-6);
  EXPECT_GT(std::abs(seen.find("energy.kinetic").value() - projection.observed("energy.kinetic")), 1e-4);
}

TEST(RodChain, SpringsHoldUpToTheStepThatIsSaid) {
  RodChainDef d = chain(Treatment::penalty, 40);
  d.direction = {0.05, -1, 0}, d.substeps = 1;
  const double limit = RodRun(d, 1).system->limit(Limit::stable_dt, RodRun(d, 1).state, 0).value();
  RodRun below(d, 0.97 * limit), above(d, 1.05 * limit);
  below.seconds(1);
  EXPECT_LT(below.gap, 0.01);
  above.seconds(0.2);
  EXPECT_FALSE(above.gap < 1);
}

TEST(RodChain, CommandsActAndStatesCopy) {
  RodRun r(chain(Treatment::lagrange, 3), 1.0 / 240);
  Command c;
  c.kind = CommandKind::set_parameter, c.name = "gravity";
  r.system->apply(r.state, c);
  r.seconds(0.5);
  EXPECT_LT(r.observed("energy.kinetic"), 1e-20);
  c.kind = CommandKind::impulse, c.index = 2, c.vector = {0, 0, 0.1};
  r.system->apply(r.state, c);
  State copy = State::deserialize(r.state.serialize());
  r.seconds(0.5);
  EXPECT_GT(r.x(2).z, 0.01);
  Workspace fresh;
  for (uint64_t k = 120; k < 240; ++k)
    r.system->step(copy, {static_cast<double>(k) / 240, 1.0 / 240, k, fresh, r.arena});
  EXPECT_EQ(copy, r.state);
  c.kind = CommandKind::pin;
  EXPECT_THROW(r.system->apply(r.state, c), Error);
}

}  // namespace
}  // namespace truestep
