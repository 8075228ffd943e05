// The scalar of a flow on a grid: its sum changes only by sources and through open sides, it stays between
// its extremes, and it is carried with second order in space and time.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

constexpr Vec3 kDown{0, -9.81, 0};

/// The largest and the smallest value of the scalar in any cell.
struct Extremes {
  double low = 1e300, high = -1e300;
};
Extremes extremes(const GridFlow& run) {
  const mac::MacGrid& g = run.model().grid;
  const auto q = run.state.f64(*run.state.find("scalar"));
  Extremes out;
  for (size_t k = 0; k < g.cells[2]; ++k) {
    for (size_t j = 0; j < g.cells[1]; ++j) {
      for (size_t i = 0; i < g.cells[0]; ++i) {
        const double v = q[g.at(i, j, k)];
        out.low = std::min(out.low, v), out.high = std::max(out.high, v);
      }
    }
  }
  return out;
}

GridFluidDef box_of(SideKind kind, A advection) {
  GridFluidDef d;
  d.cells = {32, 48};
  d.size = {1, 1.5};
  d.origin = Vec3{-0.5, 0, 0};
  d.advection = advection;
  d.all = FlowSideDef{kind, {}};
  d.scalar = ScalarDef{.initial = "x^2+(y-0.4)^2<0.05 ? 1 : 0", .expansion = 0.3};
  return d;
}

/// Runs for 4 s and looks whether the sum has changed by more than rounding, and whether values have left
/// [0, 1] by more than `tolerance`.
void expect_kept(const GridFluidDef& d, double tolerance, const std::string& what) {
  GridFlow run(d, 0.02, 1, kDown);
  const double before = run.observed("scalar.total");
  double low = 0, high = 0, fastest = 0;
  for (int n = 0; n < 200; ++n) {
    run.steps(1);
    const Extremes e = extremes(run);
    low = std::min(low, e.low), high = std::max(high, e.high);
    fastest = std::max(fastest, run.observed("speed.max"));
  }
  const double change = run.observed("scalar.total") / before - 1;
  std::printf("  %-28s change of the sum %8.1e, values %.1e to 1 + %.1e, up to %.2f m/s\n", what.c_str(),
              change, low, high - 1, fastest);
  // Some 10^3 additions of some 10^3 cells' values.
  EXPECT_LT(std::abs(change), 1e-12) << what;
  EXPECT_GE(low, -tolerance) << what;
  EXPECT_LE(high, 1 + tolerance) << what;
  EXPECT_GT(fastest, 0.3) << what << ": it flows";
}

// With the paths of MacCormack's method a rising blob had gained 12 to 30 % here.
TEST(GridFluidScalar, ItsSumStaysInAClosedBox) {
  // Pressure by transforms leaves divergence of rounding, which a step turns into as much of the values.
  constexpr double kRounding = 1e-11;
  expect_kept(box_of(SideKind::slip, A::central), kRounding, "central");
  expect_kept(box_of(SideKind::slip, A::semi_lagrangian), kRounding, "semi_lagrangian");
  expect_kept(box_of(SideKind::wall, A::maccormack), kRounding, "maccormack, walls");
  expect_kept(box_of(SideKind::slip, A::bfecc), kRounding, "bfecc");
  GridFluidDef d = box_of(SideKind::slip, A::central);
  d.order = GridFluidDef::Order::fourth;
  expect_kept(d, kRounding, "central, fourth order");
  d = box_of(SideKind::slip, A::central);
  d.scalar->diffusivity = 1e-3;
  expect_kept(d, kRounding, "diffusing");
}

TEST(GridFluidScalar, ItsSumStaysInAPeriodicBox) {
  GridFluidDef d = box_of(SideKind::periodic, A::central);
  d.initial = {"0.5", "0.3"};
  expect_kept(d, 1e-11, "periodic");
  d.order = GridFluidDef::Order::fourth;
  expect_kept(d, 1e-11, "periodic, fourth order");
}

TEST(GridFluidScalar, ItsSumStaysAroundObstacles) {
  // Pressure is solved to a tolerance of 1e-6 of the flow's own divergence.
  constexpr double kSolved = 1e-6;
  for (const A advection : {A::central, A::maccormack}) {
    const std::string name = advection == A::central ? "central, " : "maccormack, ";
    GridFluidDef d = box_of(SideKind::slip, advection);
    d.obstacles.resize(1);
    d.obstacles[0].center = {0.05, 0.9, 0}, d.obstacles[0].radius = 0.15;
    expect_kept(d, kSolved, name + "obstacle");
    d.obstacles[0].displacement = {"0.2*sin(3*t)", "-0.1*(1-cos(2*t))"};
    expect_kept(d, kSolved, name + "moving obstacle");
  }
}

TEST(GridFluidScalar, ItsSumStaysBesideASecondFluidAndInSpace) {
  GridFluidDef d = box_of(SideKind::slip, A::central);
  d.second_fluid.emplace();
  d.second_fluid->where = "y-1.2+0.1*x", d.second_fluid->density = 2;
  expect_kept(d, 1e-5, "two fluids");
  d = box_of(SideKind::slip, A::maccormack);
  d.cells = {12, 16, 10}, d.size = {1, 1.5, 1};
  expect_kept(d, 1e-11, "in space");
}

// Control of all of the above, and of the source: a thousandth of the blob's sum in 4 s is seen.
TEST(GridFluidScalar, ASourceAddsWhatItSays) {
  GridFluidDef d = box_of(SideKind::slip, A::central);
  d.scalar->source = "1e-4*(1+t)";
  GridFlow run(d, 0.02, 1, kDown);
  const double before = run.observed("scalar.total");
  run.steps(200);
  const double added = 1.5 * 1e-4 * (4 + 8);
  EXPECT_NEAR(run.observed("scalar.total") - before, added, 1e-9 * added);
  EXPECT_GT(run.observed("scalar.total") / before - 1, 1e-3);
}

// What flows out is what is missing: dye between an inflow and an outflow, at 1 m/s.
TEST(GridFluidScalar, WhatLeavesThroughAnOpenSideIsMissing) {
  GridFluidDef d = box_of(SideKind::slip, A::central);
  d.initial = {"0", "1"};
  d.scalar = ScalarDef{.initial = "y>0.2 && y<1 ? 1 : 0"};
  d.sides.y_min = FlowSideDef{SideKind::inflow, {"0", "1"}};
  d.sides.y_max = FlowSideDef{SideKind::outflow, {}};
  GridFlow run(d, 0.02);
  const double before = run.observed("scalar.total");
  EXPECT_NEAR(before, 0.8, 0.02) << "to a cell";
  run.steps(20);
  EXPECT_NEAR(run.observed("scalar.total"), before, 1e-3) << "the front is three cells before the side";
  run.steps(25);
  EXPECT_NEAR(run.observed("scalar.total"), 0.4, 0.02);
  run.steps(60);
  EXPECT_NEAR(run.observed("scalar.total"), 0, 1e-3);
}

/// Mean error of the stream function, carried as a scalar, of Taylor and Green's eddies that drift through a
/// periodic box without friction: an exact solution of Euler's equations.
double drift_error(int64_t cells, A advection) {
  const std::string x = "2*pi*x", y = "2*pi*y";
  GridFluidDef d;
  d.cells = {cells, cells};
  d.all = FlowSideDef{SideKind::periodic, {}};
  d.origin = Vec3{};
  d.advection = advection;
  d.initial = {"1+sin(" + x + ")*cos(" + y + ")", "0.5-cos(" + x + ")*sin(" + y + ")"};
  d.scalar = ScalarDef{.initial = "sin(" + x + ")*sin(" + y + ")"};
  GridFlow run(d, 0.3 / double(cells));
  const auto steps = static_cast<uint64_t>(std::llround(double(cells) / 0.3));
  run.steps(steps);
  const mac::MacGrid& g = run.model().grid;
  const auto q = run.state.f64(*run.state.find("scalar"));
  double sum = 0;
  for (size_t j = 0; j < g.cells[1]; ++j) {
    for (size_t i = 0; i < g.cells[0]; ++i) {
      const Vec3 p = g.position(mac::kCentre, g.at(i, j, 0));
      const double k = 2 * std::numbers::pi;
      const double exact = std::sin(k * (p.x - run.t())) * std::sin(k * (p.y - 0.5 * run.t()));
      sum += std::abs(q[g.at(i, j, 0)] - exact);
    }
  }
  return sum / double(g.cell_count());
}

TEST(GridFluidScalar, IsCarriedWithSecondOrderInSpaceAndTime) {
  const double coarse = drift_error(24, A::central), middle = drift_error(48, A::central),
               fine = drift_error(96, A::central);
  std::printf("  mean errors %.2e %.2e %.2e, orders %.2f %.2f\n", coarse, middle, fine,
              std::log2(coarse / middle), std::log2(middle / fine));
  // The slope is cut at the crests, which costs a little of the order.
  EXPECT_GT(std::log2(coarse / middle), 1.7);
  EXPECT_GT(std::log2(middle / fine), 1.8);
  // Control: by a flow of first order in time it is of first order too.
  EXPECT_LT(std::log2(drift_error(48, A::maccormack) / drift_error(96, A::maccormack)), 1.5);
}

}  // namespace
}  // namespace truestep::test
