// Rotating obstacles: a spinning cylinder against the vortex that it maintains, a bar against its mirror
// image.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

// A cylinder of radius R spins at W in unbounded fluid: u = W R^2 / r along the circles is exact, and the
// fluid takes a torque of 4 pi density viscosity W R^2 from it. The sides of the box give the exact flow.
struct Spun {
  double error, torque;
};
Spun spinning_cylinder(int64_t cells, GridFluidDef::Advection advection, double speed) {
  constexpr double kRadius = 0.5, kViscosity = 0.1;
  GridFluidDef d;
  d.cells = {cells, cells};
  d.size = {4, 4};
  d.origin = Vec3{-2, -2, 0};
  d.viscosity = kViscosity, d.advection = advection, d.tolerance = 1e-8;
  const std::string r2 = "(x^2+y^2)", in = "x^2+y^2 < 0.25 ? ";
  const std::string u = std::to_string(-speed) + "*y", v = std::to_string(speed) + "*x";
  const std::vector<std::string> exact = {in + u + " : " + u + "*0.25/" + r2,
                                          in + v + " : " + v + "*0.25/" + r2};
  d.all = FlowSideDef{SideKind::inflow, exact};
  d.initial = d.exact = exact;
  ObstacleDef o{.center = {}, .radius = kRadius};
  o.angle = std::to_string(speed) + "*t";
  d.obstacles = {o};
  GridFlow run(d, 0.02);
  run.steps(100);
  return {run.observed("error.exact"),
          -run.observed("obstacle.torque") / (4 * std::numbers::pi * kViscosity * speed * kRadius * kRadius)};
}

TEST(GridFluidTurning, ASpinningCylinderKeepsUpItsVortex) {
  using A = GridFluidDef::Advection;
  const Spun coarse = spinning_cylinder(32, A::central, 2), fine = spinning_cylinder(64, A::central, 2);
  std::printf("  rms %.2e, %.2e m/s; torque %.4f, %.4f of the exact\n", coarse.error, fine.error,
              coarse.torque, fine.torque);
  EXPECT_NEAR(fine.torque, 1, 0.01);
  // Second order removes three quarters; the exact flow has a kink at the wall, which costs some of that.
  EXPECT_LT(fine.error, 0.4 * coarse.error);
  EXPECT_LT(std::abs(fine.torque - 1), 0.4 * std::abs(coarse.torque - 1));
  // Control: walls of first order, whose viscosity acts through the cylinder within a step.
  EXPECT_GT(std::abs(spinning_cylinder(32, A::maccormack, 2).torque - 1), 0.1);
}

TEST(GridFluidTurning, ABarTurnedByARightAngleIsTheOtherBar) {
  const auto drag = [](const Vec3& half, const std::string& angle) {
    GridFluidDef d;
    d.cells = {48, 32};
    d.size = {3, 2};
    d.viscosity = 0.05;
    d.initial = {"1", "0"};
    d.sides.x_min = FlowSideDef{SideKind::inflow, {"1", "0"}};
    d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
    d.sides.y_min = d.sides.y_max = FlowSideDef{SideKind::slip, {}};
    ObstacleDef o{.shape = ObstacleDef::Shape::box, .center = {1.01, 1.02, 0}, .half = half};
    o.angle = angle;
    d.obstacles = {o};
    GridFlow run(d, 0.02);
    run.steps(30);
    return run.observed("obstacle.drag");
  };
  const double across = drag({0.1, 0.33, 1}, ""), turned = drag({0.33, 0.1, 1}, "pi/2");
  EXPECT_NEAR(turned, across, 1e-6 * across);
  EXPECT_GT(std::abs(drag({0.33, 0.1, 1}, "") - across), 0.1 * across)
      << "control: along the stream it drags less";
}

// A paddle that turns in a closed box stirs the fluid and lets none through.
TEST(GridFluidTurning, APaddleInAClosedBoxLeavesNoDivergence) {
  using A = GridFluidDef::Advection;
  for (const A advection : {A::central, A::maccormack}) {
    GridFluidDef d;
    d.cells = {48, 48};
    d.viscosity = 0.01, d.advection = advection, d.tolerance = 1e-9;
    ObstacleDef o{.shape = ObstacleDef::Shape::box, .center = {0.5, 0.5, 0}, .half = {0.3, 0.06, 1}};
    o.angle = "2*t";
    d.obstacles = {o};
    GridFlow run(d, 0.02);
    double most = 0;
    for (int k = 0; k < 60; ++k) run.steps(1), most = std::max(most, run.observed("divergence.max"));
    std::printf("  divergence %.1e 1/s, speed %.2f m/s, torque %.4f N m\n", most, run.observed("speed.max"),
                run.observed("obstacle.torque"));
    // 0.6 m/s over cells of 1/48 m are 29 1/s; the solve leaves 1e-9 of the mean square.
    EXPECT_LT(most, 1e-6);
    EXPECT_GT(run.observed("speed.max"), 0.4);
    EXPECT_LT(run.observed("speed.max"), 2);
    EXPECT_LT(run.observed("obstacle.torque"), 0) << "the fluid holds it back";
  }
}

}  // namespace
}  // namespace truestep::test
