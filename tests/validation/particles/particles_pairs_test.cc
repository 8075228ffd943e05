// Pair forces and user expressions of the system "particles".
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

ParticlesDef cloud(int n, double size) {
  ParticlesDef d;
  d.gravity = Vec3{};
  for (int i = 0; i < n; ++i) {
    const auto u = uniform4(4, 1, i), w = uniform4(4, 2, i);
    d.positions.push_back(Vec3{u[0], u[1], u[2]} * size);
    d.velocities.push_back({w[0] - 0.5, w[1] - 0.5, w[2] - 0.5});
  }
  return d;
}

TEST(ParticlesPairs, EveryLawKeepsTheMomentum) {
  const PairForceDef laws[] = {PowerLawDef{0.02, 0.4, 0.05, 2}, PowerLawDef{-0.01, 0.3, 0.02, 1},
                               PowerLawDef{-1e-4, 0.3, 0.02, 3}, SoftRepulsionDef{5, 0.2},
                               ViscosityDef{0.5, 0.3}};
  for (const PairForceDef& law : laws) {
    ParticlesDef d = cloud(300, 1);
    d.pair_forces = {law};
    ParticlesRun r(d);
    const double before = r.observed("momentum.x");
    const Vec3 v = r.v(0);
    r.run(100);
    // Opposite bits per pair; 300 sums of 100 steps round to 1e-13 of the single momenta (about 0.3).
    EXPECT_NEAR(r.observed("momentum.x"), before, 1e-11);
    EXPECT_GT(norm(r.v(0) - v), 1e-4);  // control: the law acts
  }
}

TEST(ParticlesPairs, ConservativeLawsKeepTheEnergy) {
  // Soft repulsion is continuous, so leapfrog keeps the energy to (omega h)^2 / 24 of what is exchanged.
  ParticlesDef d = cloud(300, 1);
  d.pair_forces = {SoftRepulsionDef{5, 0.2}};
  ParticlesRun r(d, 1.0 / 1000);
  const double before = r.observed("energy.total"), potential = r.observed("energy.potential");
  r.run(1000);
  EXPECT_NEAR(r.observed("energy.total") / before, 1, 1e-4);
  EXPECT_GT(std::fabs(r.observed("energy.potential") / potential - 1), 0.05);  // control: energy moved
}

TEST(ParticlesPairs, ViscosityOnlyTakesEnergyAndEvensVelocitiesOut) {
  ParticlesDef d = cloud(200, 0.3);
  d.pair_forces = {ViscosityDef{0.2, 0.5}};
  ParticlesRun r(d);
  double last = r.observed("energy.kinetic");
  const double first = last;
  for (int k = 0; k < 20; ++k) {
    r.run(5);
    const double now = r.observed("energy.kinetic");
    EXPECT_LE(now, last);
    last = now;
  }
  EXPECT_LT(last, 0.1 * first);
}

TEST(ParticlesPairs, TwoBodiesCircleEachOther) {
  // Reduced problem: strength S = 1 between masses 1 and 1 at distance 1, omega^2 = S (1/m1 + 1/m2) / r^3
  // = 2.
  ParticlesDef d;
  d.gravity = Vec3{};
  const double omega = std::sqrt(2.0);
  d.positions = {{-0.5, 0, 0}, {0.5, 0, 0}};
  d.velocities = {{0, -0.5 * omega, 0}, {0, 0.5 * omega, 0}};
  d.pair_forces = {PowerLawDef{1, 5, 0, 2}};
  d.integrator = "yoshida4";
  ParticlesRun r(d, 2 * 3.14159265358979323846 / omega / 1000);
  r.run(1000);
  EXPECT_LT(norm(r.x(0) - Vec3{-0.5, 0, 0}), 1e-8);
  d.pair_forces = {PowerLawDef{1, 5, 0, 3}};
  ParticlesRun control(d, 2 * 3.14159265358979323846 / omega / 1000);
  control.run(900);
  EXPECT_GT(norm(control.x(0) - r.x(0)), 0.1);
}

TEST(ParticlesExpression, EqualsTheBuiltInDrag) {
  ParticlesDef a = cloud(50, 1), b = a;
  a.gravity = b.gravity = Vec3{0, -9.81, 0};
  a.mass = b.mass = 0.7;
  a.quadratic_drag = 0.02, a.linear_drag = 0.1;
  b.expression = ExpressionDef{"-(0.1 + c * sqrt(vx^2 + vy^2 + vz^2)) * vx",
                               "-(0.1 + c * sqrt(vx^2 + vy^2 + vz^2)) * vy",
                               "-(0.1 + c * sqrt(vx^2 + vy^2 + vz^2)) * vz",
                               {{"c", 0.02}}};
  ParticlesRun ra(a), rb(b);
  ra.run(240), rb.run(240);
  // The same operations in another order: some units in the last place per step.
  for (size_t i = 0; i < 50; ++i) {
    EXPECT_LT(norm(ra.x(i) - rb.x(i)), 1e-13);
    EXPECT_LT(norm(ra.v(i) - rb.v(i)), 1e-13);
  }
  EXPECT_GT(norm(ra.v(0) - Vec3{0, -9.81, 0}), 0.1);  // control: drag matters
}

TEST(ParticlesExpression, KnowsTimePositionAndMass) {
  ParticlesDef d;
  d.gravity = Vec3{};
  d.positions = {{1, 0, 0}};
  d.mass = 2;
  d.expression = ExpressionDef{"-m * 9 * x", "m * 2 * t", "0", {}};
  d.integrator = "rk4";
  ParticlesRun r(d, 1.0 / 1000);
  r.run(1000);
  EXPECT_NEAR(r.x(0).x, std::cos(3.0), 1e-10);  // rk4 at omega h = 0.003
  EXPECT_NEAR(r.x(0).y, 1.0 / 3, 1e-12);
}

TEST(ParticlesExpression, FaultsNamePointerAndCharacter) {
  ParticlesDef d;
  d.positions = {{0, 0, 0}};
  d.expression = ExpressionDef{"vx +", "sin(nope)", "0", {}};
  try {
    ParticlesRun r(d);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "scene_invalid");
    ASSERT_EQ(e.issues().size(), 2u);
    EXPECT_EQ(e.issues()[0].pointer, "/expression/fx");
    EXPECT_NE(e.issues()[0].message.find("column 5"), std::string::npos);
    EXPECT_EQ(e.issues()[1].pointer, "/expression/fy");
    EXPECT_NE(e.issues()[1].message.find("nope"), std::string::npos);
  }
}

}  // namespace
}  // namespace truestep
