// Flocks beside closed forms: Cucker and Smale with constant influence (reference case
// particles.cucker_smale_const), and Vicsek's order parameter where everybody sees everybody.
#include <cmath>

#include "tests/unit/flocking_rig.h"

namespace truestep::flocking {
namespace {

using testing_rig::FlockRun;

FlockingDef cucker_smale() {
  FlockingDef d;
  d.rule = Rule::cucker_smale, d.count = 50, d.coupling = 1;
  return d;
}

/// Largest difference to v_i(t) - mean = (v_i(0) - mean) exp(-K t) at K t = 1, and of the mean itself.
double fault(const FlockingDef& d, uint64_t steps) {
  FlockRun run(d, 1.0 / static_cast<double>(steps));
  const Vec3 mean{run.observe("velocity.mean.x"), run.observe("velocity.mean.y"),
                  run.observe("velocity.mean.z")};
  std::vector<Vec3> start;
  for (size_t i = 0; i < 50; ++i) start.push_back(run.velocity(i) - mean);
  run.step(steps);
  double worst = 0;
  constexpr double kFactor = 0.367879441171442322;
  for (size_t i = 0; i < 50; ++i) worst = std::max(worst, norm(run.velocity(i) - mean - start[i] * kFactor));
  return worst;
}

TEST(FlockingValidation, CuckerSmaleWithConstantInfluence) {
  // The method has order 4: an error of (K h)^5 / 120 in each of 1 / h steps, times the factor exp(-1) and
  // differences to the mean of at most 1.2 m/s.
  const double coarse = fault(cucker_smale(), 20), fine = fault(cucker_smale(), 40);
  EXPECT_LT(coarse, 1.2 * 0.368 * std::pow(0.05, 4) / 120 * 1.1);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.1);
  // Control: influence that decays is slower.
  FlockingDef decaying = cucker_smale();
  decaying.decay = 0.5;
  EXPECT_GT(fault(decaying, 20), 0.1);
}

TEST(FlockingValidation, CuckerSmaleKeepsTheMeanVelocity) {
  FlockingDef d = cucker_smale();
  d.decay = 0.4;
  FlockRun run(d, 0.05);
  const double before = run.observe("velocity.mean.x");
  run.step(100);
  // Rounding: 100 steps of 50 x 50 sums of numbers of order 1.
  EXPECT_NEAR(run.observe("velocity.mean.x"), before, 1e-13);
}

/// Root of the mean square of Vicsek's order parameter over 200 steps.
double order(double noise) {
  FlockingDef d;
  d.rule = Rule::vicsek, d.space = Space::plane, d.count = 500, d.noise = noise;
  d.half_extents = {1, 1, 0}, d.radius = 1000, d.speed = 0.03;
  FlockRun run(d, 1);
  double sum = 0;
  run.step(2);
  for (int k = 0; k < 200; ++k) {
    run.step();
    const double m = run.observe("polarisation");
    sum += m * m;
  }
  return std::sqrt(sum / 200);
}

TEST(FlockingValidation, VicseksOrderWhereEverybodySeesEverybody) {
  // All headings are one mean direction turned by angles uniform in +-noise/2, so the mean of their cosines
  // is s = sin(noise/2) / (noise/2), and of N headings <m^2> = s^2 + (1 - s^2) / N.
  constexpr double kTurn = 6.283185307179586;
  for (const double noise : {0.5, 2.0, 4.0, kTurn}) {
    const double s = std::sin(0.5 * noise) / (0.5 * noise), expected = std::sqrt(s * s + (1 - s * s) / 500);
    // 200 draws of a mean of 500 cosines: a standard error of at most 1 / sqrt(2 * 500 * 200) = 0.0022.
    EXPECT_NEAR(order(noise), expected, 0.009) << noise;
  }
  // Control: a noise 5 % larger is beyond the tolerance (s falls by 0.015).
  EXPECT_GT(std::abs(order(2.1) - order(2.0)), 0.009);
}

}  // namespace
}  // namespace truestep::flocking
