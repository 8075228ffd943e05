// Reference cases rigid.A01_pendulum (IFToMM/UDC simple pendulum) and rigid.double_pendulum_90_90, recomputed
// in quadruple precision; energy and momentum balance for longer chains.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/pendulum/pendulum.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
using namespace pendulum;
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

PendulumDef chain(std::vector<double> angles) {
  PendulumDef d;
  d.links = static_cast<int>(angles.size());
  d.angles = std::move(angles);
  return d;
}

TEST(PendulumReference, SimplePendulumFromTheHorizontal) {
  const PendulumField field(chain({kQuarter}), {0, -9.81, 0});
  for (const char* name : {"rk4", "dopri5", "step_doubling", "yoshida4"}) {
    SteppedField run(field, *find_integrator(name), 1e-3, {.tolerance = 1e-13});
    double p[6];
    run.steps(1000);
    field.positions(run.state.f64(0), p);
    // The fourth-order methods are some 1e-10 off at h = 1e-3.
    EXPECT_NEAR(p[3], -0.98629175113187531936, 1e-9) << name;
    EXPECT_NEAR(p[4], -0.16501085312554116875, 1e-9) << name;
    run.steps(9000);
    field.positions(run.state.f64(0), p);
    EXPECT_NEAR(p[3], 0.27508746257611686005, 2e-8) << name;
    EXPECT_NEAR(p[4], -0.96141920509912506427, 2e-8) << name;
  }
  // Control: gravity 9.80665 is another pendulum.
  const PendulumField other(chain({kQuarter}), {0, -9.80665, 0});
  SteppedField run(other, *find_integrator("rk4"), 1e-3);
  run.steps(1000);
  double p[6];
  other.positions(run.state.f64(0), p);
  EXPECT_GT(std::abs(p[4] - -0.16501085312554116875), 1e-4);
}

TEST(PendulumReference, DoublePendulumFromTheHorizontal) {
  const PendulumField field(chain({kQuarter, kQuarter}), {0, -9.81, 0});
  SteppedField run(field, *find_integrator("dopri5"), 1e-3, {.tolerance = 1e-14});
  const double expected[][5] = {
      {1, -0.62508769980639063, -1.0345850856800123, -3.9222795728879766, -1.3030992486963312},
      {2, -0.48297153425175438, -1.3240487123023625, 3.0652881920734013, 2.949271547571619},
      {5, -0.62718670506653073, -1.3013155502098117, 2.1254086738429107, 3.8818887272656074},
      {10, -0.56847466401595019, -0.5263937279324047, 6.0783848857619649, -9.6813606817088788}};
  double done = 0;
  for (const auto& row : expected) {
    run.steps(static_cast<uint64_t>(std::lround((row[0] - done) * 1000)));
    done = row[0];
    // Chaotic: rounding errors of 1e-15 grow some 1e5-fold until t = 10.
    const double tolerance = row[0] < 3 ? 1e-11 : 1e-8;
    EXPECT_NEAR(run.x(0), row[1], tolerance) << "t = " << row[0];
    EXPECT_NEAR(run.x(1), row[2], tolerance);
    EXPECT_NEAR(run.v(0), row[3], 10 * tolerance);
    EXPECT_NEAR(run.v(1), row[4], 10 * tolerance);
  }
}

TEST(Pendulum, LongChainsKeepTheirEnergyAndDampingTakesIt) {
  PendulumDef d = chain(std::vector<double>(50, 1.0));
  d.length = 0.02, d.masses.assign(50, 0.1), d.masses.back() = 3;
  const auto drift = [](const PendulumDef& def, double h) {
    const PendulumField field(def, {0, -9.81, 0});
    SteppedField run(field, *find_integrator("rk4"), h);
    const double before = run.energy();
    run.steps(static_cast<uint64_t>(std::lround(1 / h)));
    return (run.energy() - before) / std::abs(before);
  };
  // rk4's energy error falls like h^5 at least; a wrong term in the equations would leave a constant.
  const double coarse = std::abs(drift(d, 2e-4)), fine = std::abs(drift(d, 1e-4));
  EXPECT_LT(fine, 1e-6);
  EXPECT_TRUE(fine < coarse / 12 || fine < 1e-11) << coarse << ' ' << fine;
  d.damping = 0.05;
  EXPECT_LT(drift(d, 1e-4), -1e-4);
}

TEST(Pendulum, AnImpulseChangesTheMomentumOfAFreeDirection) {
  // On a single vertical rod an impulse J across it gives theta' = J / (m l); along it, nothing.
  const PendulumField one(chain({0.0}), {0, -9.81, 0});
  const std::vector<double> hanging = {0};
  EXPECT_NEAR(one.response(hanging, 0, {2, 0, 0})[0], 2, 1e-15);
  EXPECT_NEAR(one.response(hanging, 0, {0, 2, 0})[0], 0, 1e-15);
  // Two links at a right angle: J along the second rod moves both masses of the second rod alike.
  const PendulumField two(chain({0.0, kQuarter}), {0, -9.81, 0});
  const std::vector<double> bent = {0, kQuarter};
  const auto change = two.response(bent, 1, {1, 0, 0});
  EXPECT_NEAR(change[0], 0.5, 1e-15);
  EXPECT_NEAR(change[1], 0, 1e-15);
}

}  // namespace
}  // namespace truestep::test
