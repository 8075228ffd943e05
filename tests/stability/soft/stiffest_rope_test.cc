// Almost inextensible ropes with the method that they choose themselves: their steps are solved at a cost
// that does not grow with the stiffness, and nothing gains energy.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stability/soft/own_method_run.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::OwnMethodRun;

MassSpringDef rope_from_a_pin(double stiffness, int links, const Vec3& to) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = to, .links = links};
  d.pinned = {"first"};
  d.mass = 0.01, d.stiffness = stiffness;
  return d;
}

struct Rope : OwnMethodRun {
  Rope(double stiffness, int links, const Vec3& to, double dt = 1.0 / 60)
      : OwnMethodRun(rope_from_a_pin(stiffness, links, to), dt) {}
};

TEST(StiffestRope, SwingsWithoutGainAndAtACostThatStiffnessDoesNotRaise) {
  for (const int links : {20, 100}) {
    for (const double k : {1e8, 1e10, 1e11, 1e12, 1e13}) {
      Rope rope(k, links, {1, 1, 0});
      const double start = rope.observe("energy.total");
      int iterations = 0;
      double most = start;
      for (int i = 0; i < 300; ++i) {
        rope.step();
        most = std::max(most, rope.observe("energy.total"));
        iterations += rope.report().iterations;
      }
      // Less than a hundred-thousandth of what 1 m of fall releases.
      EXPECT_LT(most - start, 1e-5 * start) << links << ' ' << k;
      EXPECT_LT(iterations, 300 * 20) << links << ' ' << k;
      // At most 1 kg hangs on it, and pulls with up to a hundred times its weight when it whips.
      EXPECT_LT(rope.observe("strain.max"), 2000 / k) << links << ' ' << k;
    }
  }
}

// 1e8 N/m and 1e13 N/m differ by a strain of about 1e-7 per newton of pull: the motion is the same until
// small differences have grown, by some hundred times in half a second.
TEST(StiffestRope, MovesAsAnInextensibleOneDoes) {
  Rope soft(1e8, 20, {1, 1, 0}), stiff(1e13, 20, {1, 1, 0}), softest(1e3, 20, {1, 1, 0});
  for (int i = 0; i < 30; ++i) soft.step(), stiff.step(), softest.step();
  EXPECT_LT(norm(soft.tip() - stiff.tip()), 1e-4);
  EXPECT_GT(norm(softest.tip() - stiff.tip()), 1e-3) << "control: a soft rope is somewhere else";
}

TEST(StiffestRope, HangsStill) {
  for (const double k : {1e8, 1e13}) {
    Rope rope(k, 100, {0, 0, 0});
    for (int i = 0; i < 100; ++i) rope.step();
    EXPECT_LT(rope.observe("energy.kinetic"), 1e-12) << k;
    EXPECT_NEAR(rope.observe("reaction.y"), 1.01 * 9.81, 1e-2) << k;
  }
}

// An almost flat sheet hangs by two corners: its tensions grow until it sags.
TEST(StiffestRope, ASheetWithRigidThreadsGainsNothing) {
  for (const double k : {1e9, 1e12}) {
    MassSpringDef d;
    d.cloth_grid = ClothGridShape{
        .origin = {-0.7, 1.9, 0}, .edge_u = {1.4, 0, 0}, .edge_v = {0, -0.9, 0.9}, .nx = 6, .ny = 6};
    d.density = 0.25;
    d.stiffness = k, d.shear_stiffness = 100, d.bending_stiffness = 2;
    d.pinned = {"corner_00", "corner_10"};
    OwnMethodRun sheet(d);
    const double start = sheet.observe("energy.total");
    for (int n = 0; n < 30; ++n) {
      sheet.step();
      // Control: solves accurate to a fraction of their initial residual gain 1.6 of 6 J at 1e12 N/m.
      ASSERT_LT(sheet.observe("energy.total") - start, 1e-6) << k << ' ' << n;
    }
  }
}

// A load m g halfway between two pins on a straight rope of two links of length L sags by s, where 2 k (s^2 /
// 2 L) (s / L) = m g. Its tensions grow without bound as the stiffness does: shifts of lengths that end too
// soon leave half of them missing and the rope too low, with more energy than it began with (1e-6 J of 0.04).
TEST(StiffestRope, SagsBetweenTwoPinsAsFarAsItsLoadStretchesIt) {
  for (const double k : {1e8, 1e10, 8.7e11, 1e13}) {
    MassSpringDef d;
    d.rope = RopeShape{.from = {0, 1, 0}, .to = {1.6, 1, 0}, .links = 2};
    d.pinned = {"ends"};
    d.mass = 0.0022, d.stiffness = k, d.damping = 0.05;
    OwnMethodRun rope(d);
    const double start = rope.observe("energy.total");
    double most = start;
    for (int n = 0; n < 90; ++n) {
      rope.step();
      most = std::max(most, rope.observe("energy.total"));
    }
    const double sag = 1 - load3(rope.state.f64(MassSpringColumns::position).data(), 1).y;
    const double expected = std::cbrt(0.0022 * 9.81 * 0.8 * 0.8 / k);
    EXPECT_NEAR(sag, expected, 0.02 * expected) << k;
    EXPECT_LT(most - start, 1e-3 * 0.0022 * 9.81 * expected) << k;
  }
}

// After the numbers scaled for the solve are restored, none has lost a bit.
TEST(StiffestRope, StiffnessIsWhatItWasAfterAStep) {
  Rope rope(1.1e12, 20, {1, 1, 0});
  for (int i = 0; i < 5; ++i) rope.step();
  EXPECT_GT(rope.report().softened, 0) << "control: they were smaller";
  EXPECT_EQ(rope.state.f64(MassSpringColumns::stiffness)[0], 1.1e12);
}

}  // namespace
}  // namespace truestep
