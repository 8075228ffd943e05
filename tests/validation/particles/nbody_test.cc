// Bodies against published and closed solutions: the figure-eight, the outer planets, Plummer's sphere and
// the cold collapse of a ball (reference cases ode.figure8 and nbody.*).
#include "tests/support/runs/nbody_run.h"

namespace truestep::nbody {
namespace {

using testing_rig::model_units;
using testing_rig::NbodyRun;
using testing_rig::spiral_plummer;

constexpr double kPeriod = 6.32591398292621167758900033397;

/// Largest distance of a body from where it started, after a period of the figure-eight in `steps` steps.
double closure(const char* method, double tolerance, uint64_t steps) {
  constexpr double p = 0.34711688811892693824277692032, q = 0.532724945388030229262027987692;
  NbodyDef d = model_units();
  d.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  d.velocities = {{p, q, 0}, {p, q, 0}, {-2 * p, -2 * q, 0}};
  d.integrator = method;
  if (tolerance > 0) d.tolerance = tolerance;
  NbodyRun run(d, kPeriod / static_cast<double>(steps));
  run.step(steps);
  double worst = 0;
  for (size_t i = 0; i < 3; ++i) worst = std::max(worst, norm(run.x(i) - d.positions[i]));
  return worst;
}

TEST(NbodyValidation, TheFigureEightCloses) {
  // The case demands 1e-9 at a tolerance of 1e-12; good codes reach 1e-13.
  EXPECT_LT(closure("ias15", 0, 10), 1e-13);
  EXPECT_LT(closure("dop853", 1e-12, 10), 1e-9);
  // Hermite's scheme has order 4 in its steps, which go as the root of eta: eta^2.
  const double loose = closure("hermite", 1e-3, 10), tight = closure("hermite", 1e-4, 10);
  EXPECT_LT(tight, 1e-6);
  EXPECT_NEAR(std::log10(loose / tight), 2, 0.7) << "steps are powers of two";
  // Control: leapfrog with 200 steps does not reach it; its error goes as h^2.
  const double coarse = closure("leapfrog", 0, 200), fine = closure("leapfrog", 0, 400);
  EXPECT_GT(coarse, 1e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

NbodyDef outer_planets() {
  NbodyDef d;
  d.gravitational_constant = 0.000295912208286;  // AU^3 / (Msun day^2)
  d.masses = {1.00000597682,     0.000954786104043, 0.000285583733151,
              4.37273164546e-05, 5.17759138449e-05, 1 / 1.3e8};
  d.positions = {{0, 0, 0},
                 {-3.5023653, -3.8169847, -1.5507963},
                 {9.0755314, -3.0458353, -1.6483708},
                 {8.310142, -16.2901086, -7.2521278},
                 {11.4707666, -25.7294829, -10.8169456},
                 {-15.5387357, -25.2225594, -3.1902382}};
  d.velocities = {{0, 0, 0},
                  {0.00565429, -0.0041249, -0.00190589},
                  {0.00168318, 0.00483525, 0.00192462},
                  {0.00354178, 0.00137102, 0.00055029},
                  {0.0028893, 0.00114527, 0.00039677},
                  {0.00276725, -0.00170702, -0.00136504}};
  return d;
}

TEST(NbodyValidation, TheOuterPlanetsAfter200000Days) {
  const Vec3 reference[] = {{1.23584254235460873, -0.489943821144274976, -0.24610536181432131},
                            {2.61107957011286336, -5.07952549678798696, -2.24472067785305724},
                            {-7.66913624739130926, -4.0520522454878258, -1.33111566971138147},
                            {-5.82474394984774333, 15.3371737535725234, 6.78246340991760849},
                            {20.6639802475150218, 20.5829560424598647, 7.89479541474820209},
                            {36.5669506988226044, -13.7676844012596253, -15.0434692218232635}};
  const auto fault = [&](NbodyDef d, double dt) {
    NbodyRun run(d, dt);
    const double before = run.observe("energy.total");
    run.step(static_cast<uint64_t>(std::llround(200000 / dt)));
    double worst = 0;
    for (size_t i = 0; i < 6; ++i) worst = std::max(worst, norm(run.x(i) - reference[i]));
    return std::pair(worst, std::abs(run.observe("energy.total") / before - 1));
  };
  // Six bodies: ias15 by itself. The case allows 1e-10 AU for methods of its class.
  const auto [position, energy] = fault(outer_planets(), 100);
  EXPECT_LT(position, 1e-10);
  EXPECT_LT(energy, 1e-14) << "2e-15 where rounding is a random walk";
  // Control: leapfrog at 10 days, for which the case gives 5e-6 of energy and 0.1 AU.
  NbodyDef d = outer_planets();
  d.integrator = "leapfrog";
  const auto [far, drift] = fault(d, 10);
  EXPECT_GT(far, 0.01);
  EXPECT_LT(drift, 5e-6);
}

/// After 200,000 days: error of position (AU) and relative error of energy, then the largest of the latter on
/// the way.
std::array<double, 3> planets_by(const char* method, double dt) {
  NbodyDef d = outer_planets();
  d.integrator = "ias15";
  NbodyRun exact(d, 1000);
  exact.step(200);
  d.integrator = method;
  NbodyRun run(d, dt);
  const double before = run.observe("energy.total");
  const auto error = [&] { return std::abs(run.observe("energy.total") / before - 1); };
  double largest = 0, far = 0;
  for (uint64_t left = static_cast<uint64_t>(200000 / dt); left > 0;) {
    const uint64_t some = std::min<uint64_t>(left, 97);
    run.step(some), left -= some;
    largest = std::max(largest, error());
  }
  for (size_t i = 0; i < 6; ++i) far = std::max(far, norm(run.x(i) - exact.x(i)));
  return {far, error(), largest};
}

TEST(NbodyValidation, WisdomAndHolmansSplittingOfTheOuterPlanets) {
  // The case: REBOUND's WHFast, the same splitting, ends at 3.5e-10 of energy and 7.8e-7 AU with steps of 10
  // days and at a hundred times both with 100 (order 2); energies at one moment depend on the splitting
  // alone, positions on rounding of the start as well.
  const auto fine = planets_by("wisdom_holman", 10), coarse = planets_by("wisdom_holman", 100);
  EXPECT_NEAR(fine[1], 3.5e-10, 0.1e-10);
  EXPECT_NEAR(coarse[1], 3.5e-8, 0.1e-8);
  EXPECT_LT(fine[0], 1e-6);
  EXPECT_NEAR(std::log10(coarse[0] / fine[0]), 2, 0.02);
  // Nothing grows: the energy oscillates by the mass of the planets times (h/period)^2 = 1e-3 times 5e-6.
  EXPECT_LT(fine[2], 1e-8);
  // Control: leapfrog with 10 days is worse than this with 100.
  EXPECT_GT(planets_by("leapfrog", 10)[2], 5 * coarse[2]);
}

/// Largest relative error of energy over ten times, G = M = 1, of 200 stars, two of which circle each other
/// closely.
double cluster_drift(const char* method, double setting) {
  NbodyDef d = model_units();
  d.groups = {PlummerDef{.count = 200, .cut = 10}};
  d.positions = {{3, 0, 0}, {3.004, 0, 0}}, d.mass = 0.01;
  d.velocities = {{0, 0.5 - std::sqrt(0.02 / 0.004) / 2, 0}, {0, 0.5 + std::sqrt(0.02 / 0.004) / 2, 0}};
  d.softening = 1e-4, d.integrator = method, d.method = Method::direct;
  const bool own_steps = std::string_view(method) == "hermite";
  if (own_steps) d.tolerance = setting;
  NbodyRun run(d, own_steps ? 0.125 : setting);
  const double before = run.observe("energy.total");
  double worst = 0;
  for (int k = 0; k < 4; ++k) {
    run.step(static_cast<uint64_t>(0.25 / run.h));
    worst = std::max(worst, std::abs(run.observe("energy.total") / before - 1));
  }
  return worst;
}

TEST(NbodyValidation, BlockTimeStepsFollowAClosePair) {
  // A pair at 0.004 revolves 90 times per unit of time, a star crosses the cluster in two. Aarseth's eta is
  // the square of a step over the motion's time scale, and the scheme has order 4: eta^2.
  const double usual = cluster_drift("hermite", 0.01), fine = cluster_drift("hermite", 0.0025);
  EXPECT_LT(usual, 1e-4);
  EXPECT_LT(fine, usual / 8);
  // Control: a common step for all, with 500 per revolution of the pair like theirs, is a method of second
  // order; 20 per revolution lose the pair.
  EXPECT_GT(cluster_drift("leapfrog", 1.0 / 2048), 10 * fine);
}

/// J, of the def's start.
double potential(NbodyDef d) {
  d.method = Method::direct;
  return NbodyRun(d, 0.01).observe("energy.potential");
}

TEST(NbodyValidation, PotentialAndForcesOfThePlummerSpiral) {
  // Compensated double sums of the cases; 1e-12 is theirs.
  EXPECT_NEAR(potential(spiral_plummer(1024)) / -0.29103289167732854, 1, 1e-12);
  EXPECT_NEAR(potential(spiral_plummer(4096)) / -0.2935478495474635, 1, 1e-12);
  NbodyDef soft = spiral_plummer(4096);
  soft.softening = 0.05;
  EXPECT_NEAR(potential(soft) / -0.29268077366106293, 1, 1e-12);
  // Control: another softening is another energy.
  soft.softening = 0.051;
  EXPECT_GT(std::abs(potential(soft) / -0.29268077366106293 - 1), 1e-5);

  const NbodyDef d = spiral_plummer(1024);
  NbodyRun run(d, 0.01);
  std::vector<double> a(3 * 1024);
  Attraction(d).accelerations(run.state, run.state.f64(Columns::position), a, run.workspace, run.arena);
  const Vec3 reference{-0.0054868172333514985, -0.0055760082719986045, -0.043364336045992394};
  EXPECT_LT(norm(load3(a.data(), 0) - reference), 1e-12 * norm(reference));
  double mean = 0;
  for (size_t i = 0; i < 1024; ++i) mean += norm(load3(a.data(), i)) / 1024;
  EXPECT_NEAR(mean / 0.24832263957986395, 1, 1e-12);
}

TEST(NbodyValidation, PlummersSphereIsInBalance) {
  NbodyDef d = model_units();
  constexpr double kN = 20000;
  d.groups = {PlummerDef{.count = static_cast<int64_t>(kN), .cut = 300}};
  d.softening = 1e-3;
  NbodyRun run(d, 0.01);
  // E = -3 pi/64, W = -3 pi/32; a sum of N draws differs by 1/sqrt(N) of its spread, here at most 2 of it.
  const double w = run.observe("energy.potential"), e = run.observe("energy.total");
  EXPECT_NEAR(w / -0.29452431127404311611, 1, 4 / std::sqrt(kN));
  EXPECT_NEAR(e / -0.14726215563702155805, 1, 4 / std::sqrt(kN));
  EXPECT_NEAR(run.observe("virial_ratio"), 1, 4 / std::sqrt(kN));
  EXPECT_NEAR(run.observe("half_mass_radius"), 1.3047660265041067002, 0.03);
  // Control: a ball of uniform density with the same mass and radius is not one.
  d.groups = {SphereDef{.count = static_cast<int64_t>(kN)}};
  EXPECT_GT(std::abs(NbodyRun(d, 0.01).observe("energy.potential") / -0.2945 - 1), 0.5);
}

/// Half-mass radius at time t of a cold ball, G = M = R = 1.
double collapsed_to(double t, double force_error) {
  NbodyDef d = model_units();
  d.groups = {SphereDef{.count = 20000}};
  d.softening = 0.02, d.force_error = force_error, d.method = Method::tree;
  NbodyRun run(d, 0.005);
  run.step(static_cast<uint64_t>(std::llround(t / 0.005)));
  return run.observe("half_mass_radius");
}

TEST(NbodyValidation, AColdBallFallsIntoItself) {
  // Every shell falls as r = r0 cos^2 b, t = t_ff (2/pi) (b + sin(2b)/2), t_ff = 1.1107; at b = pi/4 r = r0/2
  // at t = 0.909.
  constexpr double kFree = 1.1107207345395915618;
  const double b = 0.7853981633974483, t = kFree * (2 / 3.141592653589793) * (b + 0.5 * std::sin(2 * b));
  const double before = collapsed_to(0, 1e-3), half = collapsed_to(t, 1e-3);
  EXPECT_NEAR(before, std::pow(0.5, 1.0 / 3), 0.01);
  // The case's 2 % of a time: in radius at that moment dr/dt = 1.4/s times 0.02 t_ff = 0.03; softening and
  // the graininess of 20,000 bodies take less.
  EXPECT_NEAR(half, 0.5 * before, 0.015);
}

}  // namespace
}  // namespace truestep::nbody
