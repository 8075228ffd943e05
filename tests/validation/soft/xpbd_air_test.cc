// Air on position-based cloth and ropes: terminal velocities, lift, and that still air never adds energy to a
// moving body, however light.
#include <cmath>

#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

XpbdDef sheet(Precision precision, double density = 0.2) {
  XpbdDef d;
  d.cloth_grid = ClothGridShape{.nx = 11, .ny = 11};
  d.density = density;
  d.wind = Vec3{};
  d.precision = precision;
  return d;
}

TEST(XpbdAir, FlatSheetFallsAtItsTerminalVelocity) {
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    for (const double density : {0.2, 0.002}) {
      XpbdDef d = sheet(precision, density);
      // A plate: a flexible sheet would flutter.
      d.flexural_rigidity = 10;
      XpbdRun run(d);
      run.seconds(1);
      double mean = 0;
      for (size_t i = 0; i < 121; ++i) mean += run.velocity(i).y / 121;
      // 1/2 rho C v^2 = sigma g; the fall has e-folding times of v / 2 g, 0.08 s at most. The force is
      // reduced as if all neighbours responded in the same way, and points on the border lack some: a
      // fraction of what gravity adds in a substep of 1/600 s remains.
      const double v = std::sqrt(2 * density * 9.81 / (1.2 * 1.2));
      EXPECT_NEAR(mean, -v, 0.2 * 9.81 / 600) << density;
    }
  }
}

TEST(XpbdAir, WithoutWindThereIsNone) {
  XpbdDef d = sheet(Precision::f64);
  d.wind.reset();
  XpbdRun run(d);
  run.seconds(1);
  EXPECT_NEAR(run.velocity(60).y, -9.81, 1e-9);
}

TEST(XpbdAir, RopeFallsAtItsTerminalVelocity) {
  XpbdDef d;
  d.rope = RopeShape{.to = {1, 0, 0}, .links = 20};
  d.density = 0.05, d.thickness = 0.01, d.wind = Vec3{0, 1, 0};
  XpbdRun run(d);
  run.seconds(6);
  // 1/2 rho C d v^2 = lambda g against air that rises at 1 m/s.
  const double v = std::sqrt(2 * 0.05 * 9.81 / (1.2 * 1.2 * 0.01));
  EXPECT_NEAR(run.velocity(10).y, 1 - v, 1e-3 * v);
}

TEST(XpbdAir, LeaningSheetIsLifted) {
  // Wind along x on a sheet that leans by 30 degrees pushes along its normal, n = (-sin, cos, 0): half a
  // plate's force as lift across the wind, and tan 30 times that as drag.
  XpbdDef d = sheet(Precision::f64);
  const double s = 0.5, c = std::sqrt(0.75);
  d.cloth_grid->edge_u = {c, s, 0};
  d.wind = Vec3{10, 0, 0};
  XpbdRun run(d, 1e-4, {});
  run.step();
  const double force = 0.5 * 1.2 * 1.2 * (10 * s) * (10 * s);
  // The motion in a step, 9e-3 m/s of 5 m/s, changes the force by 4e-3.
  EXPECT_NEAR(run.observe("momentum.x"), force * s * 1e-4, 5e-3 * force * s * 1e-4);
  EXPECT_NEAR(run.observe("momentum.y"), -force * c * 1e-4, 5e-3 * force * c * 1e-4);
}

TEST(XpbdAir, StillAirOnlySlowsWhateverTheWeightAndStep) {
  for (const double density : {0.2, 1e-4}) {
    for (const double dt : {1.0 / 30, 1.0 / 240}) {
      XpbdDef d = sheet(Precision::f64, density);
      d.velocity = {3, -20, 5}, d.substeps = 1;
      XpbdRun run(d, dt, {});
      double before = run.observe("energy.kinetic");
      for (int k = 0; k < 30; ++k) {
        run.step();
        const double now = run.observe("energy.kinetic");
        ASSERT_LE(now, before) << density << " " << dt;
        // Nor is it thrown back, except for what the border responds less.
        ASSERT_LE(run.velocity(60).y, 0.01 * 20);
        before = now;
      }
    }
  }
}

}  // namespace
}  // namespace truestep
