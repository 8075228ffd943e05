// Steady flows, solved for directly: the cavity against its spectral profiles, against the same flow stepped
// to its end, and against Kovasznay's flow.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/fluids/cavity.h"
#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

TEST(GridFluidSteady, CavityAtReynolds1000IsTheSpectralOneOfFourthOrder) {
  using Order = GridFluidDef::Order;
  double rms[2][3] = {};
  for (const Order order : {Order::second, Order::fourth}) {
    for (int k = 0; k < 3; ++k) {
      GridFlow run(steady_cavity(int64_t{32} << k, order), 1);
      run.steps(1);
      rms[order == Order::fourth][k] = cavity_rms(run);
      std::printf("  order %d, %d cells: rms %.5f, %.0f iterations, change %.1e, divergence %.1e\n",
                  order == Order::fourth ? 4 : 2, 32 << k, cavity_rms(run), run.observed("steady.iterations"),
                  run.observed("steady.change"), run.observed("divergence.max"));
      EXPECT_LT(run.observed("divergence.max"), 1e-10);
    }
  }
  // OpenFOAM's error on this grid against Ghia's table; order 2.4 to 3.4 from 32 to 128 cells were seen.
  EXPECT_LT(rms[1][2], 0.0019);
  EXPECT_GT(std::log2(rms[1][0] / rms[1][1]), 2);
  EXPECT_GT(std::log2(rms[1][1] / rms[1][2]), 3) << "set after seeing 3.35";
  EXPECT_GT(std::log2(rms[0][1] / rms[0][2]), 1.8);
  EXPECT_GT(rms[0][2], 0.0019) << "control: second order does not reach it";
}

// The steady differences are those that are stepped in time: a flow stepped for long ends at the steady one.
TEST(GridFluidSteady, TheFlowFoundIsTheOneThatTimeEndsIn) {
  GridFluidDef d = steady_cavity(32, GridFluidDef::Order::second);
  d.viscosity = 0.01;
  d.sides.x_max = FlowSideDef{SideKind::slip, {}};
  d.force = {"0.1*y", "0"};
  GridFlow found(d, 1);
  found.steps(1);
  d.stepping = GridFluidDef::Stepping::rk3;
  GridFlow stepped(d, 0.1);
  stepped.steps(400);
  double apart = 0, pressure = 0;
  for (double x = 0.1; x < 1; x += 0.1) {
    for (double y = 0.1; y < 1; y += 0.1) {
      for (const size_t c : {0, 1})
        apart = std::max(apart, std::abs(found.velocity(c, x, y) - stepped.velocity(c, x, y)));
    }
  }
  const mac::MacGrid& g = found.model().grid;
  const auto p = found.state.f64(2), q = stepped.state.f64(2);
  const double first = p[g.at(0, 0, 0)] - q[g.at(0, 0, 0)];
  for (size_t j = 0; j < 32; ++j) {
    for (size_t i = 0; i < 32; ++i)
      pressure = std::max(pressure, std::abs(p[g.at(i, j, 0)] - q[g.at(i, j, 0)] - first));
  }
  std::printf("  velocities %.1e m/s, pressures %.1e m^2/s^2 apart\n", apart, pressure);
  // A change of 1e-6 in the last iteration; the slowest eddy loses exp(-40 viscosity 2 pi^2) in 40 s.
  EXPECT_LT(apart, 1e-5);
  EXPECT_LT(pressure, 1e-4) << "largest beside the lid's ends";
  // Control: after a twentieth of the time it is different.
  GridFlow early(d, 0.1);
  early.steps(20);
  EXPECT_GT(std::abs(early.velocity(0, 0.5, 0.5) - found.velocity(0, 0.5, 0.5)), 1e-3);
}

// Kovasznay's flow of Reynolds number 40 between sides that give it: of second order.
TEST(GridFluidSteady, KovasznaysFlowIsFoundToSecondOrder) {
  const auto error = [](int64_t cells) {
    GridFluidDef d;
    d.cells = {cells, cells};
    d.origin = Vec3{-0.5, -0.5, 0};
    d.viscosity = 0.025, d.stepping = GridFluidDef::Stepping::steady;
    d.exact = {"1 - exp(-0.963740544195767*x)*cos(2*pi*y)",
               "-0.963740544195767/(2*pi)*exp(-0.963740544195767*x)*sin(2*pi*y)"};
    d.all = FlowSideDef{SideKind::inflow, d.exact};
    GridFlow run(d, 1);
    run.steps(1);
    return run.observed("error.exact");
  };
  const double coarse = error(16), middle = error(32), fine = error(64);
  std::printf("  rms %.2e %.2e %.2e m/s\n", coarse, middle, fine);
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.15);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.15);
}

// A viscosity lowered step by step leads to flows that a start from rest would not find.
TEST(GridFluidSteady, ALowerViscosityStartsFromTheFlowBefore) {
  GridFlow run(steady_cavity(48, GridFluidDef::Order::second), 1);
  run.steps(1);
  const double before = run.observed("energy.kinetic");
  run.system->apply(run.state, {.kind = CommandKind::set_parameter, .value = 5e-4, .name = "viscosity"});
  run.steps(1);
  EXPECT_GT(std::abs(run.observed("energy.kinetic") - before), 1e-4);
  GridFluidDef d = steady_cavity(48, GridFluidDef::Order::second);
  d.viscosity = 5e-4;
  GridFlow fresh(d, 1);
  fresh.steps(1);
  EXPECT_NEAR(run.observed("energy.kinetic"), fresh.observed("energy.kinetic"), 1e-6);
}

}  // namespace
}  // namespace truestep::test
