// Electrostatics between particles against a double loop, a closed orbit and the energy balance.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

/// Charges of both signs and unequal masses in a cube of 2 m.
ParticlesDef plasma(size_t n) {
  ParticlesDef d;
  d.gravity = Vec3{};
  for (size_t i = 0; i < n; ++i) {
    const auto u = uniform4(5, 0, i), w = uniform4(5, 1, i);
    d.positions.push_back(Vec3{u[0], u[1], u[2]} * 2);
    d.charges.push_back(i % 2 ? 1 + u[3] : -1 - u[3]);
    d.masses.push_back(0.5 + w[0]);
  }
  d.coulomb = CoulombDef{.constant = 2, .softening = 0.1};
  return d;
}

Vec3 summed(const ParticlesDef& d, size_t i) {
  Vec3 force;
  for (size_t j = 0; j < d.positions.size(); ++j) {
    if (j == i) continue;
    const Vec3 r = d.positions[i] - d.positions[j];
    const double s = norm2(r) + d.coulomb->softening * d.coulomb->softening;
    force += r * (d.coulomb->constant * d.charges[i] * d.charges[j] / (s * std::sqrt(s)));
  }
  return force;
}

TEST(ParticlesCoulomb, ForcesAndEnergyAreThoseOfADoubleLoop) {
  const ParticlesDef d = plasma(301);
  ParticlesRun r(d);
  std::vector<double> a(3 * 301);
  Evaluation e{r.workspace, r.arena};
  const Phase at{0, r.state.f64(particles::columns::position), r.state.f64(particles::columns::velocity),
                 r.state};
  r.system->force_field().acceleration(at, a, e);
  double worst = 0, largest = 0, energy = 0;
  for (size_t i = 0; i < 301; ++i) {
    const Vec3 expected = summed(d, i) / d.masses[i];
    worst = std::max(worst, norm(load3(a.data(), i) - expected));
    largest = std::max(largest, norm(expected));
    for (size_t j = 0; j < i; ++j) {
      energy += 2 * d.charges[i] * d.charges[j] / std::sqrt(norm2(d.positions[i] - d.positions[j]) + 0.01);
    }
  }
  EXPECT_LT(worst, 1e-13 * 301 * largest);  // sums of 300 terms in another order
  EXPECT_NEAR(r.observed("energy.potential") / energy, 1, 1e-11);
  // The control: signs count.
  ParticlesDef like = d;
  for (double& q : like.charges) q = std::fabs(q);
  EXPECT_GT(norm(summed(like, 0) - summed(d, 0)), 0.1 * norm(summed(d, 0)));
}

/// Root mean square over some particles of the tree's error over what the charges of either sign do alone.
double tree_error(ParticlesDef d, double asked) {
  d.coulomb->method = CoulombMethod::tree, d.coulomb->force_error = asked;
  ParticlesRun r(d);
  const size_t n = d.positions.size();
  std::vector<double> a(3 * n);
  Evaluation e{r.workspace, r.arena};
  const Phase at{0, r.state.f64(particles::columns::position), r.state.f64(particles::columns::velocity),
                 r.state};
  r.system->force_field().acceleration(at, a, e);
  Vec3 net;
  double sizes = 0;
  for (size_t i = 0; i < n; ++i) {
    const Vec3 force = load3(a.data(), i) * d.masses[i];
    net += force, sizes += norm(force);
  }
  EXPECT_LT(norm(net), 1e-13 * sizes) << "what the tree's forces add up to is taken away";
  ParticlesDef positive = d, negative = d;
  for (size_t i = 0; i < n; ++i) (d.charges[i] > 0 ? negative : positive).charges[i] = 0;
  double sum = 0;
  constexpr size_t kSome = 200;
  for (size_t k = 0; k < kSome; ++k) {
    const size_t i = k * (n / kSome);
    const double q = d.charges[i];
    positive.charges[i] = negative.charges[i] = q;
    const Vec3 repelled = summed(positive, i), attracted = summed(negative, i);
    (q > 0 ? negative : positive).charges[i] = 0;
    const double size = norm(repelled) + norm(attracted);
    const double fault = norm(load3(a.data(), i) * d.masses[i] - repelled - attracted) / size;
    sum += fault * fault / kSome;
  }
  return std::sqrt(sum);
}

TEST(ParticlesCoulomb, ATreeOfEitherSignKeepsToTheErrorAskedFor) {
  const ParticlesDef both = plasma(6000);
  ParticlesDef like = both;
  for (double& q : like.charges) q = std::fabs(q);
  for (const ParticlesDef& d : {both, like}) {
    EXPECT_LT(tree_error(d, 1e-3), 1e-3);
    EXPECT_LT(tree_error(d, 1e-4), 1e-4);
    // Control: a tree is in use.
    EXPECT_GT(tree_error(d, 3e-2), 1e-3);
  }
}

TEST(ParticlesCoulomb, EnergyByTheTree) {
  ParticlesDef d = plasma(6000);
  for (double& q : d.charges) q = std::fabs(q);
  d.coulomb->method = CoulombMethod::direct;
  const double exact = ParticlesRun(d).observed("energy.potential");
  d.coulomb->method = CoulombMethod::automatic;
  const double by_tree = ParticlesRun(d).observed("energy.potential");
  // An error of 1e-3 of a force is less of a potential, which falls more slowly.
  EXPECT_NEAR(by_tree / exact, 1, 1e-3);
  EXPECT_NE(by_tree, exact) << "6,000 are summed by the tree";
}

TEST(ParticlesCoulomb, KeepsEnergyAndMomentum) {
  const auto drift = [](double h, uint64_t steps) {
    ParticlesRun r(plasma(100), h);
    const double before = r.observed("energy.total");
    r.run(steps);
    for (const char* p : {"momentum.x", "momentum.y", "momentum.z"}) EXPECT_NEAR(r.observed(p), 0, 1e-11);
    EXPECT_GT(r.observed("energy.kinetic"), 10);  // much has happened
    return std::fabs(r.observed("energy.total") / before - 1);
  };
  // Leapfrog: second order in h.
  const double fine = drift(0.5e-3, 1000), coarse = drift(2e-3, 250);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(coarse, 4 * fine);
}

TEST(ParticlesCoulomb, OppositeChargesCircle) {
  // k q1 q2 / d^2 = m (d/2) omega^2 with d = 1, k = 1, q = +-1, m = 2: omega = 1.
  ParticlesDef d;
  d.gravity = Vec3{};
  d.positions = {{0.5, 0, 0}, {-0.5, 0, 0}};
  d.velocities = {{0, 0.5, 0}, {0, -0.5, 0}};
  d.mass = 2;
  d.charges = {1, -1};
  d.coulomb = CoulombDef{.constant = 1, .softening = 0};
  ParticlesRun r(d, 6.283185307179586 / 1000);
  r.run(1000);
  EXPECT_LT(norm(r.x(0) - d.positions[0]), 1e-4);  // leapfrog's phase: 2 pi (omega h)^2/24 is 1e-5
  d.charges = {1, 1};
  ParticlesRun control(d, 6.283185307179586 / 1000);
  control.run(1000);
  EXPECT_GT(norm(control.x(0)), 2) << "like charges part";
}

TEST(ParticlesCoulomb, ChargesStayWithTheirParticles) {
  // The middle one of three is removed; the outer two, +1 and -1, then fall towards each other.
  ParticlesDef d;
  d.gravity = Vec3{};
  d.positions = {{-1, 0, 0}, {0, 5, 0}, {1, 0, 0}};
  d.charges = {1, 7, -1};
  d.kill_boxes = {{.center = {0, 5, 0}, .half_extents = {1, 1, 1}, .where = KillBoxDef::Where::inside}};
  d.coulomb = CoulombDef{.constant = 1, .softening = 0};
  ParticlesRun r(d, 1e-3);
  r.run(2);
  ASSERT_EQ(r.count(), 2u);
  const Vec3 v0 = r.v(0), v1 = r.v(1);
  r.run(100);
  EXPECT_NEAR(r.v(0).x - v0.x, 0.1 * 0.25, 2e-4);
  EXPECT_NEAR(r.v(1).x - v1.x, -0.1 * 0.25, 2e-4);
}

TEST(ParticlesCoulomb, LorentzForceOfSingleCharges) {
  // Boris's pusher and rk4 turn opposite charges in opposite senses.
  for (const char* method : {"boris", "rk4"}) {
    ParticlesDef d;
    d.gravity = Vec3{};
    d.positions = {{}, {5, 0, 0}};
    d.velocities = {{1, 0, 0}, {1, 0, 0}};
    d.charges = {1, -2};
    d.magnetic_field = {0, 0, 1};
    d.integrator = method;
    ParticlesRun r(d, 0.01);
    r.run(100);
    EXPECT_LT(norm(r.v(0) - Vec3{std::cos(1.0), -std::sin(1.0), 0}), 1e-9) << method;
    EXPECT_LT(norm(r.v(1) - Vec3{std::cos(2.0), std::sin(2.0), 0}), 1e-8) << method;
  }
}

TEST(ParticlesCoulomb, FaultsAreNamed) {
  const auto where = [](const ParticlesDef& d) {
    std::vector<std::string> out;
    particles_table().check(&d, [&](const std::string& at, const std::string&) { out.push_back(at); });
    return out;
  };
  ParticlesDef d = plasma(4);
  EXPECT_TRUE(where(d).empty());
  d.charges.pop_back();
  EXPECT_EQ(where(d), std::vector<std::string>{"/charges"});
  d.charges.clear();
  EXPECT_EQ(where(d), std::vector<std::string>{"/coulomb"});
  d = plasma(100'001);
  EXPECT_TRUE(where(d).empty()) << "a tree sums them";
  d.coulomb->method = CoulombMethod::direct;
  EXPECT_EQ(where(d), std::vector<std::string>{"/coulomb/method"});
}

}  // namespace
}  // namespace truestep
