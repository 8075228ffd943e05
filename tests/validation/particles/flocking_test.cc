// Flocks against closed forms: Cucker and Smale with constant influence (reference case
// particles.cucker_smale_const), and Vicsek's order parameter when everybody sees everybody.
#include <cmath>

#include "tests/unit/particles/flocking_rig.h"

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

/// Vicsek et al. 1995, figure 2 a: order at density 4, speed 0.03 and radius 1, the mean over 6,000 steps.
double order_at_density_4(int64_t n, double noise) {
  FlockingDef d;
  d.rule = Rule::vicsek, d.space = Space::plane, d.sides = Sides::periodic, d.count = n, d.noise = noise;
  const double half = std::sqrt(static_cast<double>(n) / 4) / 2;
  d.half_extents = {half, half, 0}, d.radius = 1, d.speed = 0.03;
  FlockRun run(d, 1);
  run.step(1000);
  double sum = 0;
  for (int k = 0; k < 6000; ++k) run.step(), sum += run.observe("polarisation");
  return sum / 6000;
}

TEST(FlockingValidation, VicseksTransitionDependsOnTheNumberAsPublished) {
  // Below the transition (published: at a noise of 2.9 +- 0.05 for many) the order is the same for thousands
  // and for 40, slightly below the s of aligned headings, from which slow waves of direction subtract a
  // little: at most a hundredth here.
  const double s = std::sin(0.5) / 0.5, few = order_at_density_4(40, 1), many = order_at_density_4(400, 1);
  EXPECT_LT(few, s);
  EXPECT_GT(few, s - 0.01);
  EXPECT_NEAR(few, many, 0.02);
  // Above it there are patches without a common direction: the order falls as 1 / sqrt(N), here by 2 for 4
  // times as many. The mean of 6,000 steps, a tenth of them independent, is known to 2 %.
  const double loose = order_at_density_4(100, 5) / order_at_density_4(400, 5);
  EXPECT_NEAR(loose, 2, 0.2);
  // Control: at the lower noise the same quotient is 1.
  EXPECT_LT(order_at_density_4(100, 1) / many, 1.1);
}

TEST(FlockingValidation, CuckerSmalesTwoBodiesHaveAnIntegral) {
  // Two on a line: v' = -K v / (1 + (r / sigma)^2) with beta = 1, so that v + K sigma atan(r / sigma) is
  // conserved, and they reach a common velocity exactly if v(0) is below K sigma (pi / 2 - atan(r(0) /
  // sigma)) (Cucker, Smale 2007: beyond beta = 1/2 it depends on the start).
  const double range = 0.8, r0 = 0.5, k = 1,
               critical = k * range * (1.570796326794897 - std::atan(r0 / range));
  for (const double share : {0.5, 1.25}) {
    FlockingDef d;
    d.rule = Rule::cucker_smale, d.decay = 1, d.influence_range = range, d.coupling = k;
    d.positions = {{}, {r0, 0, 0}}, d.velocities = {{}, {share * critical, 0, 0}};
    FlockRun run(d, 0.01);
    const auto integral = [&] {
      const double r = run.position(1).x - run.position(0).x;
      return run.velocity(1).x - run.velocity(0).x + k * range * std::atan(r / range);
    };
    const double before = integral();
    run.step(20000);
    // Order 4: the error of a step is some (K h)^5 / 120 = 1e-12 of v, for the 200 steps in which v changes.
    EXPECT_NEAR(integral(), before, 1e-9);
    const double v = run.velocity(1).x - run.velocity(0).x;
    if (share < 1) {
      // At rest the rate is K / (1 + tan(0.51)^-2) = 0.24: exp(-47) after 200 s.
      EXPECT_LT(std::abs(v), 1e-9);
    } else {
      // The excess over K sigma times the remaining angle, about sigma / r.
      EXPECT_NEAR(v, (share - 1) * critical, k * range * range / (run.position(1).x - run.position(0).x));
    }
  }
}

TEST(FlockingValidation, CuckerSmaleFlocksAtARateBetweenItsBounds) {
  // The spread V of velocities falls at least as exp(-K psi(D) t), D being the largest distance met, and at
  // most as exp(-K t): d/dt V^2 = -(K / N^2) sum psi_ij |v_i - v_j|^2 with psi(D) <= psi_ij <= 1.
  FlockingDef d = cucker_smale();
  d.decay = 0.4, d.coupling = 0.7, d.half_extents = {2, 2, 2};
  FlockRun run(d, 0.02);
  const double start = run.observe("velocity.spread");
  double widest = 0;
  for (int k = 0; k < 500; ++k) {
    run.step();
    for (size_t i = 0; i < 50; ++i) {
      for (size_t j = 0; j < i; ++j) widest = std::max(widest, norm(run.position(i) - run.position(j)));
    }
  }
  const double rate = std::log(start / run.observe("velocity.spread")) / 10;
  const double least = 0.7 * std::pow(1 + widest * widest, -0.4);
  EXPECT_GT(rate, least);
  EXPECT_LT(rate, 0.7);
  // Control: the bounds exclude another coupling.
  d.coupling = 0.7 * least / rate * 0.9;
  FlockRun slower(d, 0.02);
  slower.step(500);
  EXPECT_LT(std::log(start / slower.observe("velocity.spread")) / 10, least);
}

}  // namespace
}  // namespace truestep::flocking
