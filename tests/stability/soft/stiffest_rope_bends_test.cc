// Almost inextensible ropes with springs from every point to the next but one, at the method that they choose
// themselves. Such a rope is flat at each of its points: a bend by an angle a makes these springs shorter by
// L a^2 / 4 only, so that shifts of lengths did not converge, and the scenes ended with exit code 4.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/stability/soft/own_method_run.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::OwnMethodRun;

MassSpringDef bending_rope(double stiffness, double bending, int links, const Vec3& to, const char* pinned) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = to, .links = links};
  d.pinned = {pinned};
  d.mass = 0.01, d.stiffness = stiffness, d.bending_stiffness = bending;
  return d;
}

TEST(StiffestRopeBends, HoldsAtTheDefaults) {
  std::mt19937 random(1);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (const double k : {1e8, 1e10, 1e12}) {
    for (const double share : {1e-4, 1e-2, 0.1}) {
      for (const char* pinned : {"first", "ends"}) {
        const int links = 2 + static_cast<int>(28 * unit());
        const Vec3 to{0.3 + unit(), 1 + unit() - 0.5, unit() - 0.5};
        OwnMethodRun rope(bending_rope(k, share * k, links, to, pinned), 1.0 / 60);
        const double start = rope.observe("energy.total");
        double most = start;
        for (int i = 0; i < 60; ++i) {
          ASSERT_NO_THROW(rope.step()) << k << ' ' << share << ' ' << pinned << ' ' << links << " at " << i;
          most = std::max(most, rope.observe("energy.total"));
        }
        // A hundred-thousandth of what a metre of fall releases.
        EXPECT_LT(most - start, 1e-5 * 9.81 * 0.01 * (links + 1)) << k << ' ' << share << ' ' << pinned;
        // The lever of a bend is a link's length times its angle, down to a tenth of a millimetre: pulls are
        // thousands of times the weight.
        EXPECT_LT(rope.observe("strain.max"), 1e-4) << k << ' ' << share << ' ' << pinned;
      }
    }
  }
}

// It hardly bends, by (F / (k L))^(1/3) at a point that a sideways force F bends: a few thousandths. So it
// falls like a rod of the same points, a'' = -g sum(r) / sum(r^2) cos a. Implicit Euler is first order: its
// error is halved with the step, to below 1 % here. The control bends freely and is a whip by then.
TEST(StiffestRopeBends, FallsLikeARod) {
  constexpr int kLinks = 20, kSteps = 240;
  constexpr double kDt = 1.0 / 480;
  double first = 0, second = 0;  // sums over the points
  for (int i = 1; i <= kLinks; ++i) first += i / double(kLinks), second += i * i / double(kLinks * kLinks);
  double angle = 0, rate = 0;
  constexpr int kFine = 100;
  for (int i = 0; i < kSteps * kFine; ++i) {
    rate -= kDt / kFine * 9.81 * first / second * std::cos(angle), angle += kDt / kFine * rate;
  }
  const auto fall = [&](double bending) {
    OwnMethodRun rope(bending_rope(1e10, bending, kLinks, {1, 1, 0}, "first"), kDt);
    for (int i = 0; i < kSteps; ++i) rope.step();
    return load3(rope.state.f64(MassSpringColumns::position).data(), kLinks);
  };
  const Vec3 rod{std::cos(angle), 1 + std::sin(angle), 0};
  EXPECT_LT(norm(fall(1e9) - rod), 0.03);
  EXPECT_GT(norm(fall(0) - rod), 0.1);
}

}  // namespace
}  // namespace truestep
