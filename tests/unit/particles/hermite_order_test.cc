// Hermite's scheme has order 4 in its steps, which go as the root of its tolerance: the error goes as its
// square.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/runs/nbody_run.h"

namespace truestep::nbody {
namespace {

// m, how far two bodies on an ellipse of eccentricity 0.5 are from their start after a period.
double closure(double tolerance) {
  NbodyDef d = testing_rig::model_units();
  d.masses = {0.75, 0.25}, d.positions = {{-0.125, 0, 0}, {0.375, 0, 0}};
  const double v = std::sqrt(3.0);
  d.velocities = {{0, -0.25 * v, 0}, {0, 0.75 * v, 0}};
  d.integrator = "hermite", d.tolerance = tolerance;
  testing_rig::NbodyRun run(d, 2 * 3.141592653589793 / 16);
  run.step(16);
  return norm(run.x(1) - d.positions[1]);
}

TEST(HermiteOrder, IsFour) {
  const double loose = closure(1e-3), tight = closure(1e-4);
  EXPECT_LT(tight, 1e-8);
  EXPECT_NEAR(std::log10(loose / tight), 2, 0.7) << "steps are powers of two";
}

}  // namespace
}  // namespace truestep::nbody
