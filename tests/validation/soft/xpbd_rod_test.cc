// Cosserat rods of the system xpbd against closed forms: a clamped rod under small and large loads
// (Euler-Bernoulli; Mattiasson 1981, "Numerical results from large deflection beam and frame problems", table
// of the cantilever under an end load), stored twist, a helical spring by Castigliano's theorem and the twist
// at which a straight rod with clamped ends buckles (Greenhill; van der Heijden, Thompson 2000).
#include <cmath>
#include <numbers>

#include "engine/base/errors.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

constexpr double kE = 1e8, kDiameter = 0.02;
constexpr double kI = std::numbers::pi / 64 * kDiameter * kDiameter * kDiameter * kDiameter;

XpbdDef straight(int links, std::vector<std::string> clamped) {
  XpbdDef d;
  d.rope = RopeShape{.to = {1, 0, 0}, .links = links};
  d.thickness = kDiameter, d.density = 2e-4;
  d.rod = RodDef{.youngs_modulus = kE, .clamped = std::move(clamped)};
  return d;
}

/// Displacement (m) down and back of the end of a rod of 1 m under an end load of F L^2 / E I = `load`.
Vec3 tip(double load, int links) {
  XpbdDef d = straight(links, {"first"});
  const double gravity = 10, mass = load * kE * kI / gravity;
  d.loads = {{links, mass}};
  // Near critical damping for the load alone, a quarter of it averaged over the rod.
  d.damping = 6 * std::sqrt(3 * kE * kI * mass) / links;
  XpbdRun run(d, 1.0 / 60, {0, -gravity, 0});
  run.seconds(12);
  const Vec3 x = run.position(static_cast<size_t>(links));
  return {1 - x.x, -x.y, x.z};
}

TEST(XpbdRods, SmallDeflectionsAreThoseOfEulerAndBernoulli) {
  // F L^3 / 3 E I; the rod's own weight of 0.002 N adds 3/8 of that fraction. Joints lump bending by links:
  // error (1 / n)^2 / 2, at 40 links 0.03 %; shear adds 3 E I / G A L^2 = 0.03 %; 1 % covers both and the
  // residual motion.
  const double load = 0.03, force = load * kE * kI, own = 0.375 * 0.002 / force;
  const double expected = load / 3 * (1 + own);
  const Vec3 at = tip(load, 40);
  EXPECT_NEAR(at.y, expected, 0.01 * expected);
  EXPECT_NEAR(at.z, 0, 1e-9);
  // Control: a load larger by 3 % would be detected.
  EXPECT_GT(std::abs(tip(1.03 * load, 40).y - expected), 0.02 * expected);
}

TEST(XpbdRods, LargeDeflectionsAreThoseOfTheElastica) {
  struct Case {
    double load, down, back;
  };
  // The rod's own weight of 0.002 N adds 3/8 of that to 0.785 N and more, 0.1 %; 40 links 0.05 % and as much
  // shear: 0.3 % of the displacement down, twice that of the displacement back, which goes with its square.
  for (const Case& c : {Case{1, 0.30172, 0.05643}, Case{2, 0.49346, 0.16064}, Case{5, 0.71379, 0.38763}}) {
    const Vec3 at = tip(c.load, 40);
    EXPECT_NEAR(at.y, c.down, 0.003 * c.down) << c.load;
    EXPECT_NEAR(at.x, c.back, 0.006 * c.back) << c.load;
    // Control: the straight line of small deflections is far off.
    EXPECT_GT(std::abs(c.load / 3 - at.y), 0.05 * c.down);
  }
}

TEST(XpbdRods, ATurnedEndStoresTwist) {
  XpbdDef d = straight(20, {"ends"});
  d.rod->twist_rate = 0.5, d.rod->damping_time = 0.01;
  XpbdRun run(d, 1.0 / 60, {});
  run.seconds(2);
  // G J phi^2 / 2 L at 1 rad; the wave that a turning end sends out has (T / t)^2 of that, below 0.1 %.
  const double shear = kE / 2.6, stored = 0.5 * shear * 2 * kI;
  EXPECT_NEAR(run.observe("energy.twist"), stored, 2e-3 * stored);
  EXPECT_LT(run.observe("energy.bending"), 1e-9 * stored);
}

TEST(XpbdRods, AHelicalSpringGivesWayByItsWiresTorsionAndBending) {
  constexpr double kRadius = 0.05, kWire = 0.004, kTurns = 5, kYoung = 2e9, kMass = 0.005;
  XpbdDef d;
  d.helix = HelixShape{.centre = {0, 0, 0},
                       .axis = {0, -1, 0},
                       .radius = kRadius,
                       .pitch = 0.01,
                       .turns = kTurns,
                       .links = 200};
  d.thickness = kWire, d.density = 0.001, d.damping = 0.0005;
  d.rod = RodDef{.youngs_modulus = kYoung, .clamped = {"first"}};
  d.loads = {{200, kMass}};
  XpbdRun run(d, 1.0 / 60, {0, -9.81, 0});
  const double start = run.position(200).y;
  run.seconds(6);
  const double sag = start - run.position(200).y;
  // A load F on the axis gives F / k with k = G d^4 / (8 D^3 n) = G J / (2 pi n R^3); at the wire's end its
  // arm is R (1 - cos) for torsion and R sin for bending: 3/2 and 1/2 E-wise (Castigliano).
  const double i = std::numbers::pi / 64 * kWire * kWire * kWire * kWire, shear = kYoung / 2.6;
  const double rate = shear * std::pow(kWire, 4) / (8 * std::pow(2 * kRadius, 3) * kTurns);
  const double per_turns = 1.5 + 0.5 * (shear * 2 * i) / (kYoung * i);
  const double weight = 9.81 * kMass, expected = weight / rate * per_turns;
  // Own weight of 1.6 g adds to the load, about a third of it: 3 % of 5 g a gram; slope of the coils 3 %.
  EXPECT_NEAR(sag, expected, 0.15 * expected);
}

/// Largest distance (m) from the axis of a rod between clamped ends, with the moment m = M L / E I and the
/// tension t = T L^2 / E I.
double off_line(double m, double t = 0, int links = 40) {
  XpbdDef d = straight(links, {"ends"});
  d.density = 0.3;
  // M = G J phi / L and E I / G J = 1 + nu.
  d.rod->twist = m * 1.3, d.rod->damping_time = 1e-3;
  XpbdRun run(d, 1.0 / 60, {0, -1e-3, 0});
  const double stretch = t * kI / (std::numbers::pi / 4 * kDiameter * kDiameter);
  for (double& x : run.state.f64(XpbdColumns::position)) x *= 1 + stretch;
  run.seconds(3);
  double most = 0;
  for (size_t i = 0; i <= size_t(links); ++i)
    most = std::max(most, std::hypot(run.position(i).y, run.position(i).z));
  return most;
}

TEST(XpbdRods, ATwistedRodBucklesAtGreenhillsMoment) {
  // Its weight bends it by 1e-6 m, ten times as much near the moment; above it, only its length holds it.
  // M L / E I = 8.9868, the first root of tan x = x twice.
  EXPECT_LT(off_line(0.95 * 8.9868), 1e-4);
  EXPECT_GT(off_line(1.05 * 8.9868), 1e-3);
}

// Onset of coiling of a rod under tension, from which loops and plectonemes grow (Coyne 1990, "Analysis of
// the formation and elimination of loops in twisted cable"): w = y + i z with
//   E I w'''' - i M w''' - T w'' = 0
// between clamped ends has a solution if 2 d (cos d - cos (m / 2)) = t sin d, d^2 = m^2 / 4 - t; for long
// rods m = 2 sqrt(t).
TEST(XpbdRods, ATwistedRodUnderTensionCoilsAtCoynesMoment) {
  constexpr double kTension = 100;
  const auto lack = [](double d) {
    return kTension * std::sin(d) - 2 * d * (std::cos(d) - std::cos(std::sqrt(d * d + kTension)));
  };
  double low = 2, high = 4;
  ASSERT_GT(lack(low), 0);
  ASSERT_LT(lack(high), 0);
  for (int k = 0; k < 60; ++k) (lack(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
  const double m = 2 * std::sqrt(low * low + kTension);
  EXPECT_NEAR(m, 2 * std::sqrt(kTension), 1);
  // 27 rad in 80 links: a link's twist is measured as twice the sine of half its angle, 0.5 % less. Straight,
  // its weight bends it by a micrometre; coiled it is a thousandth of its length off the axis or more.
  EXPECT_LT(off_line(0.95 * m, kTension, 80), 1e-4);
  EXPECT_GT(off_line(1.05 * m, kTension, 80), 1e-3);
}

TEST(XpbdRods, AreTheSameOnTwoThreadsAndFromASnapshot) {
  XpbdDef d;
  d.hair = HairShape{.strands = 600, .links = 8};
  d.thickness = 0.002;
  d.mass = 1e-4;
  d.rod = RodDef{.youngs_modulus = 1e7, .damping_time = 1e-3};
  XpbdRun one(d), two(d, 1.0 / 60, {0, -9.81, 0}, 2);
  d.rod->youngs_modulus = 1.01e7;
  XpbdRun other(d);
  for (XpbdRun* run : {&one, &two, &other}) {
    run->system->apply(run->state, {.kind = CommandKind::impulse, .index = 8, .vector = {1e-4, 0, 2e-4}});
    run->step(5);
  }
  EXPECT_EQ(one.state.hash(), two.state.hash());
  EXPECT_NE(one.state.hash(), other.state.hash());
  XpbdRun restored(d);
  d.rod->youngs_modulus = 1e7;
  XpbdRun again(d);
  again.state = one.state, again.steps = one.steps;
  one.step(5), again.step(5);
  EXPECT_EQ(one.state.hash(), again.state.hash());
}

TEST(XpbdRods, WhatMayNotBeSaidIsNamed) {
  const auto faults = [](const XpbdDef& d) {
    std::vector<std::string> out;
    xpbd_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
    return out;
  };
  using Names = std::vector<std::string>;
  XpbdDef d = straight(4, {"ends"});
  EXPECT_EQ(faults(d), Names{});
  d.precision = Precision::f32, d.bending_rigidity = 1;
  EXPECT_EQ(faults(d), (Names{"/bending_rigidity", "/precision"}));
  d = straight(4, {"middle"});
  d.rod->twist_rate = 1;
  EXPECT_EQ(faults(d), (Names{"/rod/clamped/0", "/rod/twist_rate"}));
  d = straight(4, {});
  d.thickness = 0;
  EXPECT_EQ(faults(d), Names{"/thickness"});
  XpbdDef cloth;
  cloth.cloth_grid.emplace(), cloth.rod.emplace();
  EXPECT_EQ(faults(cloth), Names{"/rod"});
}

}  // namespace
}  // namespace truestep
