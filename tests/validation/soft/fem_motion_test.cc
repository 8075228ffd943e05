// Moving finite element bodies: frequencies, conservation, recovery of crushed or inverted elements.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

FemDef cube(Law law, int cells, Cell cell) {
  FemDef d;
  d.block = SoftBlockShape{.cells_x = cells, .cells_y = cells, .cells_z = cells};
  d.element = cell;
  d.material = law, d.youngs_modulus = 1e4, d.poisson_ratio = 0.4, d.density = 1000;
  return d;
}

// fem.cantilever_freq: (beta L)^2 sqrt(EI / rho A) / L^2. A strip 50 times as long as high bends as the thin
// beam but for shear and rotation, (k h)^2 / 12 (1 + E / kappa G) / 2: 0.04 % of the first, 1 % of the third.
TEST(FemMotion, AStripHasTheFrequenciesOfABeam) {
  FemDef d;
  d.quad = QuadShape{{{0, 0, 0}, {1, 0, 0}, {1, 0.02, 0}, {0, 0.02, 0}}, 40, 1};
  d.element = Cell::quad9, d.plane = Plane::stress;
  d.material = Law::linear, d.youngs_modulus = 2e9, d.poisson_ratio = 0, d.density = 1000;
  d.modes = 3, d.pinned = {"x0"};
  const double unit = std::sqrt(2e9 * 0.02 * 0.02 / 12 / 1000) / (2 * std::numbers::pi);
  const auto held = FemRun(d).system->frequencies();
  const double cantilever[] = {1.875104068711961, 4.694091132974175, 7.854757438237613};
  for (size_t k = 0; k < 3; ++k) {
    const double beam = cantilever[k] * cantilever[k] * unit;
    EXPECT_NEAR(held[k], beam, (k == 0 ? 0.001 : k == 1 ? 0.005 : 0.012) * beam) << k;
  }
  d.pinned.clear(), d.modes = 5;
  const auto free = FemRun(d).system->frequencies();
  // Three rigid motions in the plane, then bending.
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(free[k], 0);
  EXPECT_NEAR(free[3], 4.730040744862704 * 4.730040744862704 * unit, 0.005 * free[3]);
  EXPECT_NEAR(free[4], 7.853204624095838 * 7.853204624095838 * unit, 0.012 * free[4]);
  EXPECT_GT(std::abs(free[3] / held[0] - 1), 1);
}

// The frequency observed is the one with which the body oscillates.
TEST(FemMotion, ABarSwingsWithItsFrequency) {
  FemDef d;
  d.block = SoftBlockShape{.size = {1, 0.2, 0.2}, .cells_x = 10, .cells_y = 2, .cells_z = 2};
  d.material = Law::corotated, d.youngs_modulus = 1e6, d.poisson_ratio = 0.3;
  d.pinned = {"x0"}, d.modes = 1, d.integrator = "newmark";
  FemRun run(d, 5e-3);
  const double f = run.system->frequencies()[0];
  // A small push along the first mode, which the static shape under a tip load approximates.
  for (size_t i = 0; i < run.system->body().mesh.x.size(); ++i) {
    const double x = run.system->body().mesh.x[i].x;
    run.state.f64(FemColumns::velocity)[3 * i + 1] = 1e-3 * x * x * (3 - x);
  }
  const size_t tip = run.node_at({1, 0.2, 0.2});
  std::vector<double> crossings;
  double last = 0;
  for (int k = 0; k < 4 / f / run.h; ++k) {
    run.step();
    const double now = run.displacement(tip).y;
    if (last < 0 && now >= 0)
      crossings.push_back(run.h * (static_cast<double>(run.steps) - now / (now - last)));
    last = now;
  }
  ASSERT_GE(crossings.size(), 3u);
  const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  // Newmark's period error is (omega h)^2 / 12, 2e-4 here; other modes shift a crossing by their share of 1
  // %.
  EXPECT_NEAR(1 / period, f, 0.01 * f);
}

// Crushed to 5 % of its height and released: every law except St. Venant-Kirchhoff's, which has no strength
// there, restores it, whatever the element.
TEST(FemMotion, ACrushedCubeReturnsToItsShape) {
  for (const Law law : {Law::corotated, Law::neo_hookean, Law::stable_neo_hookean, Law::mooney_rivlin}) {
    for (const Cell cell : {Cell::tet4, Cell::hex8, Cell::tet10}) {
      FemDef d = cube(law, 3, cell);
      d.second_share = law == Law::mooney_rivlin ? 0.2 : 0;
      d.pinned = {"bottom"}, d.youngs_modulus = 1e5, d.damping = 5;
      FemRun run(d, 1.0 / 60);
      const auto x = run.state.f64(FemColumns::position);
      for (size_t i = 0; i < x.size() / 3; ++i) x[3 * i + 1] *= 0.05;
      ASSERT_LT(run.observe("jacobian.min"), 0.051);
      run.step(240);
      EXPECT_LT(run.observe("displacement.max"), 1e-3)
          << static_cast<int>(law) << ' ' << element_of(kind_of(cell)).name;
      EXPECT_GT(run.observe("jacobian.min"), 0.99);
    }
  }
}

TEST(FemMotion, ACubeFallsAndRestsOnThePlane) {
  FemDef d = cube(Law::stable_neo_hookean, 3, Cell::tet4);
  d.block->origin = {0, 0.5, 0};
  d.youngs_modulus = 2e5, d.damping = 3;
  d.colliders.push_back(PlaneColliderDef{});
  d.contact_distance = 0.01;
  FemRun run(d, 1.0 / 120, {0, -9.81, 0});
  double lowest = 1;
  for (int k = 0; k < 600; ++k) {
    run.step();
    for (size_t i = 0; i < run.system->body().mesh.x.size(); ++i)
      lowest = std::min(lowest, run.position(i).y);
  }
  EXPECT_GT(lowest, 0.01 - 1e-9);
  EXPECT_LT(run.observe("energy.kinetic"), 1e-3);
  // It stands, and does not hover.
  double bottom = 1;
  for (size_t i = 0; i < run.system->body().mesh.x.size(); ++i) bottom = std::min(bottom, run.position(i).y);
  EXPECT_NEAR(bottom, 0.01, 1e-6);
}

// No external forces act on a body thrown with a spin: its momenta are conserved to rounding by central
// differences (velocity Verlet) and the midpoint rule; the energy is conserved by the midpoint rule within
// its oscillation, and implicit Euler only loses it.
TEST(FemMotion, AFreeBodyKeepsItsMomenta) {
  for (const char* method : {"velocity_verlet", "implicit_midpoint", "implicit_euler"}) {
    FemDef d = cube(Law::stable_neo_hookean, 2, Cell::hex8);
    d.integrator = method;
    FemRun run(d, 2e-3);
    const auto v = run.state.f64(FemColumns::velocity);
    for (size_t i = 0; i < v.size() / 3; ++i) {
      const Vec3 arm = run.position(i) - Vec3{0.5, 0.5, 0.5};
      store3(v.data(), i, Vec3{1, 2, -1} + cross(Vec3{0.5, 1, 2}, arm) + arm * 0.3);
    }
    const char* axes[] = {"x", "y", "z"};
    double linear[3], angular[3];
    for (int k = 0; k < 3; ++k) {
      linear[k] = run.observe(std::string("momentum.") + axes[k]);
      angular[k] = run.observe(std::string("angular_momentum.") + axes[k]);
    }
    const double energy = run.observe("energy.total");
    run.step(500);
    const bool euler = std::string_view(method) == "implicit_euler";
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(run.observe(std::string("momentum.") + axes[k]), linear[k], 1e-8 * 1000) << method;
      // Implicit Euler rotates with the velocity at the step's end: first order.
      EXPECT_NEAR(run.observe(std::string("angular_momentum.") + axes[k]), angular[k],
                  (euler ? 0.05 : 1e-8) * 1000)
          << method;
    }
    EXPECT_LT(run.observe("energy.total"), (euler ? 1 : 1.01) * energy) << method;
    EXPECT_GT(run.observe("energy.total"), (euler ? 0.9 : 0.99) * energy) << method;
  }
}

// A side moved by an expression is where the expression says at every step, whatever moves the rest.
TEST(FemMotion, AMovedSideIsWhereItsExpressionSays) {
  FemDef d = cube(Law::corotated, 3, Cell::hex8);
  d.pinned = {"bottom"};
  d.holds = {{.on = "top", .x = "0.1*sin(3*t)", .y = "0", .z = "0"}};
  FemRun run(d, 1.0 / 120);
  const size_t corner = run.node_at({1, 1, 1}), middle = run.node_at({1, 2.0 / 3, 1});
  double reach = 0;
  for (int k = 0; k < 240; ++k) {
    run.step();
    const double t = run.h * static_cast<double>(run.steps);
    EXPECT_NEAR(run.displacement(corner).x, 0.1 * std::sin(3 * t), 1e-12);
    EXPECT_EQ(run.displacement(run.node_at({0, 0, 0})), Vec3{});
    reach = std::max(reach, run.displacement(middle).x);
  }
  // The rest follows: about two thirds of the side's displacement, and in its direction.
  EXPECT_GT(reach, 0.05);
  EXPECT_LT(reach, 0.1);
}

}  // namespace
}  // namespace truestep::fem
