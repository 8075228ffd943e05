// Forces of the system "particles" against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

ParticlesDef one(const Vec3& x, const Vec3& v, const char* integrator) {
  ParticlesDef d;
  d.positions = {x};
  d.velocities = {v};
  d.integrator = integrator;
  return d;
}

TEST(ParticlesForces, FallWithQuadraticDrag) {
  // Reference case particles.drag: terminal speed 10 m/s, so c2 = m g / 100. rel 1e-6 is the case's
  // tolerance; rk4 at 1/240 s is below 1e-10. Control: linear drag with the same terminal speed misses it.
  ParticlesDef d = one({}, {}, "rk4");
  d.mass = 2;
  d.quadratic_drag = 2 * 9.81 / 100;
  ParticlesRun r(d);
  r.run(240);
  EXPECT_NEAR(-r.v(0).y / 7.5349847071769457, 1, 1e-6);
  EXPECT_NEAR(-r.x(0).y / 4.275097671086901, 1, 1e-6);
  d.quadratic_drag = 0, d.linear_drag = 2 * 9.81 / 10;
  ParticlesRun control(d);
  control.run(240);
  EXPECT_GT(std::fabs(-control.v(0).y / 7.5349847071769457 - 1), 1e-2);
}

TEST(ParticlesForces, EveryExplicitMethodDragsToItsOwnOrder) {
  for (const Integrator& m : integrators()) {
    if (m.kind != Integrator::Kind::explicit_ || m.order_with_velocity == 0) continue;
    ParticlesDef d = one({}, {}, "");
    d.integrator = std::string(m.name);
    d.quadratic_drag = 9.81 / 100;
    ParticlesRun r(d);
    r.run(240);
    // First order: h times the largest second derivative over two, 9.81 h; others are far below.
    EXPECT_NEAR(-r.v(0).y, 7.5349847071769457, m.order_with_velocity == 1 ? 9.81 / 240 : 1e-4) << m.name;
    EXPECT_NEAR(-r.x(0).y, 4.275097671086901, m.order_with_velocity == 1 ? 9.81 / 240 : 1e-4) << m.name;
  }
}

TEST(ParticlesForces, ProjectileWithLinearDragAndWind) {
  // v = w + (v0 - w - u) e^(-k t) + u with u = g / k, k = c1 / m.
  const double c1 = 0.4, m = 0.8, k = c1 / m, t = 1;
  const Vec3 v0{5, 8, -2}, w{1, 0.5, 3}, g{0, -9.81, 0};
  ParticlesDef d = one({1, 2, 3}, v0, "rk4");
  d.mass = m, d.linear_drag = c1, d.wind = w;
  ParticlesRun r(d);
  r.run(240);
  const Vec3 end = w + g / k, v = end + (v0 - end) * std::exp(-k * t);
  const Vec3 x = Vec3{1, 2, 3} + end * t + (v0 - end) * ((1 - std::exp(-k * t)) / k);
  EXPECT_LT(norm(r.v(0) - v), 1e-10);  // rk4: (k h)^4 / 120 per unit time, 1e-13
  EXPECT_LT(norm(r.x(0) - x), 1e-10);
  EXPECT_GT(norm(r.v(0) - (end + (v0 - end) * std::exp(-1.01 * k * t))), 1e-3);  // control
}

TEST(ParticlesForces, CircularOrbitAboutAnAttractorReturns) {
  ParticlesDef d = one({1, 0, 0}, {0, 2, 0}, "yoshida4");
  d.gravity = Vec3{};
  d.attractors = {{{0, 0, 0}, 4, 0}};
  ParticlesRun r(d, 3.14159265358979323846 / 1000);  // period 2 pi / 2
  r.run(1000);
  // Fourth order with omega h = 2 pi / 1000: phase error near 1e-9.
  EXPECT_LT(norm(r.x(0) - Vec3{1, 0, 0}), 1e-7);
  EXPECT_NEAR(r.observed("energy.total"), 0.5 * 4 - 4, 1e-9);
  d.attractors[0].mu = 4.01;
  ParticlesRun control(d, 3.14159265358979323846 / 1000);
  control.run(1000);
  EXPECT_GT(norm(control.x(0) - Vec3{1, 0, 0}), 1e-3);
}

TEST(ParticlesForces, ChargeCirclesInAMagneticField) {
  // omega = q B / m = 3, radius v / omega; E x B drift E/B along x for B along z and E along y.
  ParticlesDef d = one({}, {0, 0, 0}, "rk4");
  d.gravity = Vec3{};
  d.charge = 1.5, d.mass = 0.5, d.magnetic_field = {0, 0, 1}, d.electric_field = {0, 0.2, 0};
  ParticlesRun r(d, 1.0 / 1000);
  r.run(1000);
  const double w = 3, drift = 0.2;
  EXPECT_NEAR(r.x(0).x, drift * (1 - std::sin(w) / w), 1e-9);
  EXPECT_NEAR(r.x(0).y, drift * (1 - std::cos(w)) / w, 1e-9);
  EXPECT_GT(std::fabs(r.x(0).x - drift), 1e-3);  // control: drift without the circle
}

TEST(ParticlesForces, PropulsionAgainstDragReachesTheTerminalSpeed) {
  ParticlesDef d = one({}, {0.1, 0.1, 0}, "midpoint");
  d.gravity = Vec3{};
  d.propulsion = PropulsionDef{2, PropulsionDef::Along::velocity, {}};
  d.linear_drag = 0.5;
  ParticlesRun r(d);
  r.run(240 * 40);
  EXPECT_NEAR(norm(r.v(0)), 4, 1e-6);  // e^-20 of the start is left, 4e-9
  EXPECT_NEAR(r.v(0).x, r.v(0).y, 1e-12);
}

TEST(ParticlesForces, TwoMassesOnASpringSwingWithTheirReducedMass) {
  ParticlesDef d;
  d.gravity = Vec3{};
  d.positions = {{0, 0, 0}, {1.2, 0, 0}};
  d.masses = {1, 3};
  PairSpringDef s;
  s.stiffness = 75, s.rest_length = 1.0;
  d.springs = {s};
  d.integrator = "yoshida4";
  const double omega = std::sqrt(75 / 0.75);
  ParticlesRun r(d, 2 * 3.14159265358979323846 / omega / 400);
  const double energy = r.observed("energy.total");
  r.run(200);
  // Half a period: 0.2 m too long becomes 0.2 m too short; (omega h)^4 = 6e-8.
  EXPECT_NEAR(r.x(1).x - r.x(0).x, 0.8, 1e-7);
  EXPECT_NEAR(r.observed("energy.total"), energy, 1e-8);
  EXPECT_NEAR(energy, 0.5 * 75 * 0.04, 1e-14);
  EXPECT_NEAR(r.observed("momentum.x"), 0, 1e-14);
}

}  // namespace
}  // namespace truestep
