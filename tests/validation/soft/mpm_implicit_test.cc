// The implicit step of the material point method: stiff solids at any step, against closed forms and the
// explicit step.
#include <gtest/gtest.h>

#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

// A bar of Poisson ratio 0, its foot held by the sticky floor; gravity pulls upwards, so that it hangs.
MpmDef hanging(double e, Integration integration) {
  MpmDef d;
  d.precision = Precision::f64, d.cell = 0.05, d.low = {-0.4, 0, 0}, d.high = {0.4, 1.4, 0};
  d.floor = MpmDef::Floor::sticky, d.integration = integration;
  BodyDef b;
  b.center = {0, 0.5, 0}, b.half_extents = {0.1, 0.5, 1}, b.youngs_modulus = e, b.poisson_ratio = 0;
  d.bodies = {b};
  return d;
}

/// Mean displacement along the bar over that of the closed form, rho g L^2 / 3 E, after `seconds`; `most`
/// gets the greatest energy, over the elastic energy of the closed form.
double sag(double e, Integration integration, double dt, double seconds, double* most = nullptr) {
  MpmRun run(hanging(e, integration), dt, {0, 9.81, 0});
  const double start = run.observe("centre.y"), energy = run.observe("energy.total");
  const double scale = 0.2 * 1000.0 * 1000 * 9.81 * 9.81 / (6 * e);
  double last = energy;
  while (static_cast<double>(run.steps) * dt < seconds - 0.5 * dt) {
    run.step();
    const double now = run.observe("energy.total");
    if (most) *most = std::max(*most, (now - last) / scale);
    last = now;
  }
  return (run.observe("centre.y") - start) / (1000 * 9.81 / (3 * e));
}

// Waves of 316 and 1000 m/s cross 105 and 333 cells per step. Backward Euler damps the oscillation, and what
// is left is the static deflection on this grid, the same for every modulus; the closed form holds to the
// cells: the foot is held within one cell of twenty.
TEST(MpmImplicit, AStiffBarHangsAsTheClosedFormSaysInStepsOfASixtieth) {
  double most = 0;
  const double stiff = sag(1e8, Integration::implicit_steps, 1.0 / 60, 0.5, &most);
  EXPECT_NEAR(stiff, 1, 0.05);
  EXPECT_LT(most, 1e-3) << "energy never grows";
  const double stiffer = sag(1e9, Integration::implicit_steps, 1.0 / 60, 0.25, &most);
  EXPECT_NEAR(stiffer / stiff, 1, 1e-3);
  EXPECT_LT(most, 1e-3);
}

// The explicit step oscillates about the position where the implicit one rests: mean over eight periods of
// 12.6 ms, whose ends may be off by a sixteenth of a period of an oscillation as large as the mean.
TEST(MpmImplicit, RestsWhereTheExplicitStepSwingsAbout) {
  MpmRun run(hanging(1e8, Integration::explicit_steps), 2e-4, {0, 9.81, 0});
  const double start = run.observe("centre.y");
  double sum = 0;
  const int steps = 506;
  for (int k = 0; k < steps; ++k) run.step(), sum += run.observe("centre.y") - start;
  const double mean = sum / steps / (1000 * 9.81 / (3 * 1e8));
  EXPECT_NEAR(mean, sag(1e8, Integration::implicit_steps, 1.0 / 60, 0.5), 0.03);
}

// Reference case fem.bar_gravity: the tip's displacement rho g L^2 / 2 E within 1e-3. The corotated law is
// linear in the stretch of a bar of Poisson ratio 0, so that it holds for any load. The clamped end is the
// middle of a bar twice as long that is pulled at both halves: a sticky wall holds the first cell too softly
// (docs/mpm.md). Implicit steps come to rest in 40.
TEST(MpmImplicit, ABarUnderItsOwnWeightIsAsLongAsTheClosedForm) {
  for (const double cell : {0.1, 0.05}) {
    MpmDef d = hanging(1e5, Integration::implicit_steps);
    d.cell = cell, d.low.y = -1.4, d.walls = Contact::slip, d.floor = MpmDef::Floor::slip;
    d.bodies[0].center.y = 0, d.bodies[0].half_extents.y = 1;
    d.force = {"0", "y > 0 ? 9.81 : -9.81"};
    MpmRun run(d, 0.1);
    // Particles nearest to the tip, a quarter of a cell below it.
    const double place = run.observe("high.y"), rest = 1000 * 9.81 * (place - place * place / 2) / 1e5;
    run.step(40);
    const double error = (run.observe("high.y") - place) / rest - 1;
    EXPECT_LT(std::abs(error), 1e-3) << cell;
    EXPECT_LT(run.observe("energy.kinetic"), 1e-9) << "it rests";
    // Energy stored: rho^2 g^2 A L^3 / 6 E in each half.
    EXPECT_NEAR(run.observe("energy.elastic") / (2 * 0.2 * 1e6 * 9.81 * 9.81 / (6 * 1e5)), 1, 1e-3);
  }
}

}  // namespace
}  // namespace truestep::mpm
