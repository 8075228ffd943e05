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

// After the numbers scaled for the solve are restored, none has lost a bit.
TEST(StiffestRope, StiffnessIsWhatItWasAfterAStep) {
  Rope rope(1.1e12, 20, {1, 1, 0});
  for (int i = 0; i < 5; ++i) rope.step();
  EXPECT_GT(rope.report().softened, 0) << "control: they were smaller";
  EXPECT_EQ(rope.state.f64(MassSpringColumns::stiffness)[0], 1.1e12);
}

}  // namespace
}  // namespace truestep
