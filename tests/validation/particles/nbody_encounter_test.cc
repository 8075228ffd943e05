// Close encounters of planets by mercurius against ias15, whose errors are rounding.
#include "tests/support/runs/nbody_run.h"

namespace truestep::nbody {
namespace {

using testing_rig::NbodyRun;

constexpr double kG = 0.000295912208286, kJupiter = 9.54786104043e-4;  // AU^3/(Msun day^2), Msun

/// The sun, a planet like Jupiter on a circle, and a comet that passes it at a tenth of its Hill radius after
/// 600 days, with 6.1 km/s at infinity: found by integrating backwards from there.
NbodyDef comet() {
  const double a = 5.2, v = std::sqrt(kG * (1 + kJupiter) / a), hill = a * std::cbrt(kJupiter / 3);
  NbodyDef d;
  d.gravitational_constant = kG;
  d.masses = {1, kJupiter, 1e-9};
  d.positions = {{0, 0, 0}, {a, 0, 0}, {a + 0.1 * hill, 0, 0}};
  const double u = std::sqrt(3.5e-3 * 3.5e-3 + 2 * kG * kJupiter / (0.1 * hill));
  d.velocities = {{0, -kJupiter * v, 0}, {0, v, 0}, {0, v + 0.8 * u, 0.6 * u}};
  d.integrator = "ias15";
  for (Vec3& w : d.velocities) w = -w;
  NbodyRun back(d, 100);
  back.step(6);
  for (size_t i = 0; i < 3; ++i) d.positions[i] = back.x(i), d.velocities[i] = -back.v(i);
  return d;
}

/// AU, error of the comet's position after the encounter.
double comet_error(const char* method, double h) {
  NbodyDef d = comet();
  NbodyRun exact(d, 100);
  exact.step(12);
  d.integrator = method;
  NbodyRun run(d, h);
  run.step(static_cast<uint64_t>(std::llround(1200 / h)));
  return norm(run.x(2) - exact.x(2));
}

TEST(NbodyEncounter, ACometIsTurnedByAPlanetAsByIas15) {
  // A step of 20 days is a 216th of the planet's period: (2 pi/216)^2 = 8e-4 of the planets' interaction
  // (1e-3) is 8e-7 of 5 AU; the encounter amplifies the comet's error by some 2 GM/(b u^2) = 16.
  const double coarse = comet_error("mercurius", 20), fine = comet_error("mercurius", 10);
  EXPECT_LT(coarse, 5 * 8e-7 * 16);
  EXPECT_LT(fine, coarse / 2) << "order 2, but the steps begin elsewhere in the encounter";
  // Control: the splitting that ignores encounters sends it elsewhere.
  EXPECT_GT(comet_error("wisdom_holman", 20), 0.05);
}

/// Largest relative error of the energy over 100 years of three planets of 1e-4 suns whose ellipses cross
/// at 5.2 AU: they meet every ten years or so.
double crossing_drift(const char* method, double h) {
  NbodyDef d;
  d.gravitational_constant = kG;
  d.positions = {{0, 0, 0}}, d.masses = {1};
  d.groups = {OrbitDef{.mass = 1e-4, .semi_major_axis = 5.2, .eccentricity = 0.05},
              OrbitDef{.mass = 1e-4, .semi_major_axis = 5.5, .eccentricity = 0.05, .mean_anomaly = 0.6},
              OrbitDef{.mass = 1e-4, .semi_major_axis = 4.9, .eccentricity = 0.05, .mean_anomaly = -0.6}};
  d.integrator = method;
  NbodyRun run(d, h);
  const double before = run.observe("energy.total");
  double worst = 0;
  while (run.t() < 100 * 365.25) {
    run.step(10);
    worst = std::max(worst, std::abs(run.observe("energy.total") / before - 1));
  }
  return worst;
}

TEST(NbodyEncounter, PlanetsThatMeetKeepTheEnergy) {
  // Masses of 1e-4 times (2 pi h/period)^2 = 2e-3 is 2e-7, some ten times in encounters of bodies that speed
  // up.
  const double drift = crossing_drift("mercurius", 30);
  EXPECT_LT(drift, 2e-6);
  // ias15 chooses its steps: rounding of some thousand, whatever the session's step.
  EXPECT_LT(crossing_drift("ias15", 15), 1e-12);
  EXPECT_LT(crossing_drift("ias15", 30), 1e-12);
  // Control: the splitting that steps over encounters.
  EXPECT_GT(crossing_drift("wisdom_holman", 30), 10 * drift);
}

TEST(NbodyEncounter, WithoutEncountersItIsTheSplittingOfOrderTwo) {
  const auto drift = [](double h) {
    NbodyDef d;
    d.gravitational_constant = kG;
    d.positions = {{0, 0, 0}}, d.masses = {1};
    d.groups = {OrbitDef{.mass = 1e-3, .semi_major_axis = 5.2, .eccentricity = 0.05},
                OrbitDef{.mass = 3e-4, .semi_major_axis = 9.5, .eccentricity = 0.05, .mean_anomaly = 2}};
    d.integrator = "ias15";
    NbodyRun exact(d, 100);
    exact.step(100);
    d.integrator = "mercurius";
    NbodyRun run(d, h);
    run.step(static_cast<uint64_t>(std::llround(1e4 / h)));
    return norm(run.x(1) - exact.x(1));
  };
  EXPECT_NEAR(std::log2(drift(40) / drift(20)), 2, 0.1);
}

}  // namespace
}  // namespace truestep::nbody
