// Implicit viscosity: channels at steps far beyond the explicit limit, and what it conserves.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::middle_speed;
using testing_rig::SphRun;

SphDef channel() {
  SphDef d = testing_rig::channel(Method::dfsph);
  d.viscosity_step = Viscous::implicit_step;
  return d;
}

// The explicit step is limited to 0.03 (2 spacings)^2 / nu = 7.5e-5 s; these are 33 times as long. Backward
// Euler is of first order: 2.5 ms against the slowest mode's time of 0.1 s leave about 1 % of the lid's
// speed.
TEST(SphViscosity, AChannelIsDraggedAlongAtLongSteps) {
  constexpr double kTimes[] = {0.045, 0.1125, 0.225};
  constexpr double kSpeeds[] = {1.19475164053e-6, 3.62844098707e-6, 5.38628727324e-6};
  SphDef d = channel();
  d.lid_velocity = {1.25e-5, 0, 0};
  SphRun run(d, 2.5e-3);
  double t = 0;
  for (int k = 0; k < 3; ++k) {
    run.seconds(kTimes[k] - t), t = kTimes[k];
    EXPECT_EQ(run.observe("substeps"), 1);
    EXPECT_NEAR(middle_speed(run), kSpeeds[k], 0.02 * 1.25e-5) << t;  // the case's tolerance
  }
  d.viscosity = 2e-6;
  SphRun thick(d, 2.5e-3);
  thick.seconds(0.045);
  EXPECT_GT(std::abs(middle_speed(thick) - kSpeeds[0]), 0.04 * 1.25e-5) << "control: twice the viscosity";
}

TEST(SphViscosity, AForceDrivesAChannelAtLongSteps) {
  SphRun run(channel(), 2.5e-3, {1e-4, 0, 0});
  run.seconds(0.225);
  EXPECT_NEAR(middle_speed(run), 1.10998016592e-5, 0.02 * 1.25e-5);
  run.seconds(0.775);
  EXPECT_NEAR(middle_speed(run), 1.25e-5, 0.02 * 1.25e-5) << "steady";
}

// A disk in rigid rotation has no internal friction, and keeps rotating however viscous it is; a strained one
// loses its strain.
TEST(SphViscosity, ADiskGoesOnTurningHoweverThick) {
  for (const double spin : {1.0, 0.0}) {
    SphDef d;
    d.dimension = 2, d.low = {-2, -2, 0}, d.high = {2, 2, 1}, d.spacing = 0.05, d.precision = Precision::f64;
    d.xsph = 0, d.viscosity = 100, d.viscosity_step = Viscous::weiler2018;
    const Vec3 strain = spin > 0 ? Vec3{} : Vec3{1, -1, 0};
    d.bodies = {{.shape = Shape::ball, .spin = {0, 0, spin}, .strain = strain, .radius = 1}};
    SphRun run(d, 0.01);
    const double before = run.observe("energy.kinetic"), turning = run.observe("angular_momentum.z");
    run.step(10);
    const double after = run.observe("energy.kinetic");
    if (spin > 0) {
      EXPECT_NEAR(run.observe("angular_momentum.z"), turning, 1e-4 * turning);
      EXPECT_GT(after, 0.99 * before);
    } else {
      EXPECT_LT(after, 1e-3 * before) << "control";
    }
  }
}

}  // namespace
}  // namespace truestep::sph
