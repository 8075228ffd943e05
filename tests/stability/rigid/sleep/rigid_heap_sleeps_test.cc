// Heaps of mixed shapes sleep within ten seconds of rest: balls and capsules that kept rolling between others
// at a few mm/s used to keep three hundred bodies awake for 21 s, for 38 s, and forever.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
using testing::RigidRun;
namespace {

/// Twelve layers of 5 x 5 boxes, balls and capsules over a pit.
Rigid3dDef heap_of(unsigned seed) {
  Rigid3dDef d;
  d.bodies = {testing::ground()};
  for (const double side : {1.0, -1.0}) {
    d.bodies.push_back(testing::box({0.5, 20, 6}, {side * 5.5, 20, 0}));
    d.bodies.push_back(testing::box({6, 20, 0.5}, {0, 20, side * 5.5}));
  }
  for (size_t k = 1; k < d.bodies.size(); ++k)
    std::get<BoxBodyDef>(d.bodies[k]).motion = BodyDef::Motion::fixed;
  std::mt19937 random(seed);
  const auto dice = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int i = 0; i < 300; ++i) {
    const Vec3 at{(i % 5 - 2) * 1.9 + 0.2 * dice() - 0.1, 1.5 + i / 25 * 1.6,
                  (i / 5 % 5 - 2) * 1.9 + 0.2 * dice() - 0.1};
    const auto add = [&](auto b) {
      b.position = at, b.axis = {dice() - 0.5, dice() - 0.5, dice() - 0.5},
      b.angle = 2 * std::numbers::pi * dice();
      b.density = 1000;
      d.bodies.push_back(b);
    };
    if (i % 3 == 0) add(testing::box({0.5, 0.4, 0.3}, at));
    if (i % 3 == 1) add(testing::ball(0.45, at));
    if (i % 3 == 2) {
      CapsuleBodyDef c;
      c.radius = 0.3, c.half_length = 0.4;
      add(c);
    }
  }
  return d;
}

// All have fallen after some 7 s (27 m at most); the kinetic energy is then below a joule, of 4 MJ. Up to
// three balls or capsules may roll on alone over the floor: nothing stops them (see the control), nor those
// that roll or rock on others. Heaps are chaotic, so that twelve are judged together: of 128 starts 118 sleep
// within 10 s, half of them within 2 s; in the others a capsule rocks or a ball rolls on.
TEST(RigidHeapSleeps, WithinTenSecondsOfRest) {
  constexpr double kAlone = 3;
  std::vector<int> waits;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    RigidRun run(heap_of(seed));
    int rests = 0, t = 0;
    while (t < 30 && run.observed("awake") > kAlone) {
      run.seconds(1), ++t;
      if (rests == 0 && run.observed("energy.kinetic") < 1) rests = t;
    }
    // While something rolls on alone, the rest may sleep before the energy is below a joule.
    waits.push_back(rests > 0 ? t - rests : t >= 30 ? t : 0);
  }
  std::sort(waits.begin(), waits.end());
  EXPECT_LE(waits[6], 6);   // of all starts: 2
  EXPECT_LE(waits[9], 10);  // three quarters
}

// The control: a ball that rolls faster than the sleep threshold keeps rolling, forever.
TEST(RigidHeapSleeps, ABallThatRollsGoesOn) {
  const auto rolls_on = [](double speed) {
    Rigid3dDef d;
    d.bodies = {testing::ground()};
    SphereBodyDef ball = testing::ball(0.45, {0, 0.45, 0});
    ball.velocity = {speed, 0, 0}, ball.angular_velocity = {0, 0, -speed / 0.45};
    d.bodies.push_back(ball);
    RigidRun run(d);
    run.seconds(5);
    return run.v(1).x > 0.5 * speed;
  };
  // Its top moves twice as fast as its centre: 0.4 x 0.05 m/s is reached at 10 mm/s.
  EXPECT_TRUE(rolls_on(0.012));
  EXPECT_FALSE(rolls_on(0.008));
}

}  // namespace
}  // namespace truestep
