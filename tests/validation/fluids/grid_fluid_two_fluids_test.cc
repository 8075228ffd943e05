// Two fluids of different density on a grid against linear theory and statics: growth of a wave under a heavy
// layer (case fluid.rayleigh_taylor: sqrt(A g k) to 10 %), the period of a wave between two layers (10:1 and
// 100:1; the tolerance is that of fluid.standing_wave, 1 %), pressure in layers at rest (fluid.hydrostatic:
// 2 %, speeds below 1 % of sqrt(g H)).
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
constexpr double kGravity = 9.81;

GridFluidDef layers(int64_t across, int64_t high, double below, double above, const std::string& where) {
  GridFluidDef d;
  d.cells = {across, high};
  d.size = {1, double(high) / double(across)};
  d.origin = Vec3{0, -0.5 * d.size[1], 0};
  d.density = below;
  d.all = FlowSideDef{SideKind::slip, {}};
  d.sides.x_min = FlowSideDef{SideKind::periodic, {}};
  d.second_fluid = SecondFluidDef{where, above, {}};
  return d;
}

// m: amplitude of the wave cos(2 pi x) on the border, from what each column has of the upper fluid.
double amplitude(const GridFlow& run) {
  const mac::MacGrid& g = run.model().grid;
  const auto share = run.state.f64(static_cast<State::Column>(g.dimensions + 2));
  double sum = 0;
  for (size_t i = 0; i < g.cells[0]; ++i) {
    double filled = 0;
    for (size_t j = 0; j < g.cells[1]; ++j) filled += share[g.at(i, j, 0)];
    sum -= filled * g.spacing[1] * std::cos(2 * std::numbers::pi * g.coordinate(mac::kCentre, 0, double(i)));
  }
  return 2 * sum / double(g.cells[0]);
}

// 1/s, by a = a0 cosh(s t) of linear theory, up to a steepness (k a) of a tenth.
double growth(double below, double above, int64_t cells) {
  constexpr double kStart = 0.002, kSteepness = 0.1;
  GridFlow run(layers(cells, 2 * cells, below, above, "y - 0.002*cos(2*pi*x)"), 0.005, 1, {0, -kGravity, 0});
  const double volume = run.observed("second_fluid.volume"), first = amplitude(run);
  EXPECT_NEAR(first, kStart, 0.01 * kStart);
  double last = first;
  while (2 * std::numbers::pi * last < kSteepness && run.done() < 400) run.steps(4), last = amplitude(run);
  // Sums of some 5,000 cells over a hundred steps.
  EXPECT_NEAR(run.observed("second_fluid.volume"), volume, 1e-12);
  return std::acosh(last / first) / run.t();
}

TEST(GridFluidTwoFluids, AHeavyLayerFallsAsLinearTheorySays) {
  for (const double above : {2.0, 10.0}) {
    const double theory = std::sqrt((above - 1) / (above + 1) * kGravity * 2 * std::numbers::pi);
    const double a = growth(1, above, 24), b = growth(1, above, 48);
    std::printf("  %g:1 grows by %.4f, %.4f 1/s, theory %.4f: %.1f, %.1f %%\n", above, a, b, theory,
                100 * (a / theory - 1), 100 * (b / theory - 1));
    EXPECT_NEAR(b, theory, 0.1 * theory);
    EXPECT_LT(std::abs(b - theory), std::abs(a - theory));
  }
  // Control: 3:1 in the place of 2:1.
  const double theory = std::sqrt(kGravity * 2 * std::numbers::pi / 3);
  EXPECT_GT(std::abs(growth(1, 3, 24) - theory), 0.1 * theory);
}

// s, by the first time that the amplitude passes 0: a quarter of the period.
// `place`: of the border at rest, in cells above a row's lower faces.
double period(double below, double above, int64_t cells, double place) {
  const std::string where = "y - " + std::to_string(place / double(cells)) + " - 0.01*cos(2*pi*x)";
  GridFlow run(layers(cells, cells, below, above, where), 0.005, 1, {0, -kGravity, 0});
  double before = amplitude(run);
  int passed = 0;
  double at = 0;
  while (run.done() < 2000) {
    run.steps(1);
    const double now = amplitude(run);
    if (before * now < 0) {
      at = run.t() - 0.005 * now / (now - before);
      if (++passed == 3) break;
    }
    before = now;
  }
  return at / 1.25;
}

TEST(GridFluidTwoFluids, WavesBetweenLayersHaveThePeriodOfLinearTheory) {
  const double coth = 1 / std::tanh(2 * std::numbers::pi * 0.5);
  const auto theory = [&](double below, double above) {
    return 2 * std::numbers::pi /
           std::sqrt(kGravity * 2 * std::numbers::pi * (below - above) / ((below + above) * coth));
  };
  for (const double below : {10.0, 100.0}) {
    // On faces and in the middle of a row, where the row's mass made 10:1 0.96 and 1.67 % long.
    for (const double place : {0.0, 0.5}) {
      const double t = period(below, 1, 40, place), exact = theory(below, 1);
      std::printf("  %g:1 at %.1f cells: period %.4f s, theory %.4f: %.2f %%\n", below, place, t, exact,
                  100 * (t / exact - 1));
      EXPECT_NEAR(t, exact, 0.01 * exact);
      // Control: the period of water under nothing.
      EXPECT_GT(std::abs(t - theory(1, 0)), 0.01 * exact);
    }
  }
}

// A border between fluids of one density is only a mark.
TEST(GridFluidTwoFluids, FluidsOfOneDensityDoNotFeelTheirBorder) {
  GridFluidDef d = layers(24, 24, 1, 1, "y - 0.02 - 0.1*sin(2*pi*x)");
  d.sides.x_min.reset();
  d.initial = {"sin(pi*x)^2*sin(2*pi*(y+0.5))", "-sin(2*pi*x)*sin(pi*(y+0.5))^2"};
  d.viscosity = 0.01;
  GridFlow marked(d, 0.01);
  d.second_fluid->where = "y - 9";
  GridFlow plain(d, 0.01);
  d.second_fluid->where = "y - 0.02 - 0.1*sin(2*pi*x)", d.second_fluid->density = 2;
  GridFlow other(d, 0.01);
  for (GridFlow* run : {&marked, &plain, &other}) run->steps(20);
  const double energy = plain.observed("energy.kinetic");
  // The pressure's tolerance; where the border is, momentum is convected another way.
  EXPECT_NEAR(marked.observed("energy.kinetic"), energy, 0.01 * energy);
  EXPECT_GT(std::abs(other.observed("energy.kinetic") - energy), 0.1 * energy)
      << "control: twice the density";
}

TEST(GridFluidTwoFluids, LayersAtRestStayAtRestUnderTheirWeight) {
  // The border lies within a row of cells, a third above its lower faces.
  GridFluidDef d = layers(12, 24, 10, 1, "y - 1/36");
  d.all = FlowSideDef{SideKind::wall, {}};
  d.sides.x_min.reset();
  GridFlow run(d, 0.05, 1, {0, -kGravity, 0});
  const double height = 2;
  double fastest = 0;
  for (int k = 0; k < 60; ++k) run.steps(20), fastest = std::max(fastest, run.observed("speed.max"));
  std::printf("  60 s: at most %.1e m/s\n", fastest);
  EXPECT_LT(fastest, 0.01 * std::sqrt(kGravity * height));
  std::vector<double> scratch;
  const FieldView p = run.system->field(run.state, 0, 2, scratch);
  const auto slope = [&](size_t low, size_t high) {
    const auto* pressure = static_cast<const double*>(p.data);
    return (pressure[12 * low + 5] - pressure[12 * high + 5]) / (double(high - low) / 12);
  };
  std::printf("  slopes %.4f, %.4f Pa/m\n", slope(0, 11), slope(13, 23));
  EXPECT_NEAR(slope(0, 11), 10 * kGravity, 0.02 * 10 * kGravity);
  EXPECT_NEAR(slope(13, 23), kGravity, 0.02 * kGravity);
  // Control: a border that slopes by a cell over the box moves faster than a layer at rest may.
  d.second_fluid->where = "y - 1/36 - (x-0.5)/12";
  GridFlow other(d, 0.05, 1, {0, -kGravity, 0});
  other.steps(10);
  EXPECT_GT(other.observed("speed.max"), 0.01 * std::sqrt(kGravity * height));
}

// A column of heavy fluid falls over. Nothing supplies energy: what there is of it may not exceed the
// start's.
TEST(GridFluidTwoFluids, ACollapseGainsNoEnergyAtAHundredToOne) {
  for (const double ratio : {10.0, 100.0}) {
    GridFluidDef d = layers(24, 24, 1, ratio, "min(0.3-x,0.1-y)");
    d.sides.x_min.reset();
    GridFlow run(d, 0.02, 1, {0, -kGravity, 0});
    const double start = run.observed("energy.gravity"), volume = run.observed("second_fluid.volume");
    // What the heavy fluid loses when it lies flat along the floor.
    const double flat = start + (ratio - 1) * kGravity * volume * 0.5 * (volume - 0.6);
    double most = -1e300, fastest = 0;
    for (int k = 0; k < 60; ++k) {
      run.steps(1);
      most = std::max(most, run.observed("energy.gravity") + run.observed("energy.kinetic"));
      fastest = std::max(fastest, run.observed("energy.kinetic"));
    }
    std::printf("  %g:1 total %.4f to at most %.4f J, kinetic %.4f\n", ratio, start, most, fastest);
    // A hundredth for what shares of cells say of heights.
    EXPECT_LT(most, start + 0.01 * (start - flat));
    EXPECT_GT(fastest, 0.1 * (start - flat)) << "control: it does fall";
    EXPECT_NEAR(run.observed("second_fluid.volume"), volume, 1e-12);
  }
}

// A drop that falls in a gas of a thousandth of its density: freely, up to what the gas that makes way weighs
// (twice its share, 0.2 %, and more between walls) and what its edge of mixed cells loses.
TEST(GridFluidTwoFluids, ADropFallsFreelyThroughALightGas) {
  constexpr double kHeavy = 1000;
  GridFlow run(layers(32, 64, 1, kHeavy, "0.15 - sqrt((x-0.5)^2 + (y-0.5)^2)"), 0.002, 1, {0, -kGravity, 0});
  const double volume = run.observed("second_fluid.volume"), start = run.observed("energy.gravity");
  run.steps(150);
  const double free = 0.5 * kGravity * run.t() * run.t(), weight = (kHeavy - 1) * volume * kGravity;
  const double fallen = (start - run.observed("energy.gravity")) / weight;
  const double moving = run.observed("energy.kinetic") / weight;
  std::printf("  fell %.4f m, %.4f in motion, free %.4f: %.2f, %.2f %%\n", fallen, moving, free,
              100 * (fallen / free - 1), 100 * (moving / free - 1));
  // Control: convection by the velocity alone lost 9.4 % of the way and 29 % of the energy of motion.
  EXPECT_NEAR(fallen, free, 0.02 * free);
  EXPECT_NEAR(moving, free, 0.04 * free);
  EXPECT_NEAR(run.observed("second_fluid.volume"), volume, 1e-12);
}

}  // namespace
}  // namespace truestep::test
