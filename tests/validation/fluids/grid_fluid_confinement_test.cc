// Confinement of vorticity against the formula of Fedkiw, Stam and Jensen (2001, equations 9 to 11) on a
// vortex whose curl is known: strength dx (N x w), N = grad |w| / |grad |w||. For w = w0 exp(-(r/s)^2) the
// curl grows inwards, N = -r / |r|, and the force w0 exp(-(r/s)^2) strength dx turns the way that the vortex
// does.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

constexpr double kSize = 0.1, kCurl = 4;

GridFluidDef gaussian_vortex(int64_t cells, double strength) {
  GridFluidDef d;
  d.cells = {cells, cells};
  d.origin = Vec3{-0.5, -0.5, 0};
  d.advection = GridFluidDef::Advection::maccormack;
  d.all = FlowSideDef{SideKind::slip, {}};
  d.vorticity_confinement = strength;
  // u_theta = w0 s^2 / (2 r) (1 - exp(-(r/s)^2)), by x and y; 1e-12 keeps it finite in the middle.
  const std::string r2 = "(x^2+y^2+1e-12)", turn = "0.02*(1-exp(-" + r2 + "/0.01))/" + r2;
  d.initial = {"-y*" + turn, "x*" + turn};
  return d;
}

// m/s^2, largest distance of the tangential force from the formula where the curl changes (0.5 to 1.5 s),
// from two steps that differ in their confinement alone.
double force_error(int64_t cells, double strength, double formula) {
  constexpr double kStep = 1e-4;
  GridFlow with(gaussian_vortex(cells, strength), kStep), without(gaussian_vortex(cells, 0), kStep);
  with.steps(1), without.steps(1);
  double most = 0;
  for (int angle = 0; angle < 16; ++angle) {
    for (const double share : {0.6, 0.8, 1.0, 1.2, 1.4}) {
      const double r = share * kSize, a = 0.3927 * angle + 0.1, x = r * std::cos(a), y = r * std::sin(a);
      const double along = -std::sin(a) * (with.velocity(0, x, y) - without.velocity(0, x, y)) +
                           std::cos(a) * (with.velocity(1, x, y) - without.velocity(1, x, y));
      const double exact = formula / double(cells) * kCurl * std::exp(-share * share);
      most = std::max(most, std::abs(along / kStep - exact));
    }
  }
  return most;
}

TEST(GridFluidConfinement, PushesAVortexByTheFormulaOfItsCurl) {
  // Beside the largest force there; the formula's is purely tangential, so that projecting takes nothing of
  // it.
  const auto share = [](int64_t cells, double strength, double formula) {
    return force_error(cells, strength, formula) / (formula / double(cells) * kCurl);
  };
  const double a = share(32, 0.5, 0.5), b = share(64, 0.5, 0.5);
  std::printf("  error of the force %.2f, %.2f %% of w0 strength dx\n", 100 * a, 100 * b);
  // Second order in dx / s, which is a sixth with 64 cells: (dx/s)^2 = 0.024.
  EXPECT_LT(b, 0.05);
  EXPECT_LT(b, 0.5 * a);
  // Control: half as strong.
  EXPECT_GT(share(64, 0.25, 0.5), 0.1);
}

TEST(GridFluidConfinement, KeepsTheEnstrophyThatAdvectionTakes) {
  const auto kept = [](double strength) {
    GridFluidDef d = gaussian_vortex(32, strength);
    d.advection = GridFluidDef::Advection::semi_lagrangian;
    GridFlow run(d, 0.02);
    const double start = run.observed("enstrophy");
    run.steps(50);
    return run.observed("enstrophy") / start;
  };
  const double none = kept(0), some = kept(0.05), more = kept(0.1);
  std::printf("  enstrophy kept %.3f, %.3f, %.3f\n", none, some, more);
  EXPECT_LT(none, 0.9) << "control: without it the vortex loses";
  EXPECT_GT(some, none);
  EXPECT_GT(more, some);
}

}  // namespace
}  // namespace truestep::test
