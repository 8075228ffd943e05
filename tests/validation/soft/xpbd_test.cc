// Position-based cloth, ropes and blocks against closed forms: the stretch of a hanging rope for any step,
// substeps and iterations (reference case rope.elastic_stretch; Macklin, Mueller, Chentanez 2016), the
// catenary (rope.catenary), strips stretched by their weight, and what a free body conserves.
#include <array>
#include <cmath>
#include <utility>

#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

/// Ten links of k = 1000 N/m with 0.1 kg each: stretch m g N (N + 1) / 2 k.
XpbdDef hanging_rope() {
  XpbdDef d;
  d.rope = RopeShape{.to = {0, -1, 0}, .links = 10};
  d.mass = 0.1, d.stiffness = 1000;
  // Critical damping of the slowest motion along the rope, so that it comes to rest within seconds.
  d.internal_damping = 60;
  d.pinned = {"first"};
  return d;
}
constexpr double kStretch = 0.053955;

double stretch(const XpbdDef& d, double dt) {
  XpbdRun run(d, dt);
  run.seconds(8);
  return -1 - run.position(10).y;
}

TEST(XpbdValidation, StretchOfARopeIsThatOfItsStiffness) {
  struct Case {
    double dt;
    std::optional<int> substeps, iterations;
  };
  for (const Case& c : {Case{1.0 / 60, {}, {}}, Case{1.0 / 30, 1, 1}, Case{1.0 / 60, 1, 1},
                        Case{1.0 / 60, 40, 1}, Case{1.0 / 240, 2, 5}}) {
    XpbdDef d = hanging_rope();
    d.substeps = c.substeps, d.iterations = c.iterations;
    // Air drag that slows the rope must not carry it.
    d.damping = 0.05;
    // A tenth of the reference's 1e-3; what is left of the motion after 8 s is 1e-5 of it.
    EXPECT_NEAR(stretch(d, c.dt), kStretch, 1e-4 * kStretch) << c.dt;
    d.precision = Precision::f32;
    EXPECT_NEAR(stretch(d, c.dt), kStretch, 1e-4 * kStretch) << c.dt;
  }
}

TEST(XpbdValidation, StretchOfThePbdRopeIsThatOfStepAndIterations) {
  // The control of the above: the textbook's projections have no stiffness.
  XpbdDef d = hanging_rope();
  d.scheme = Scheme::pbd, d.internal_damping = 0, d.damping = 0.5;
  d.iterations = 5;
  const double few = stretch(d, 1.0 / 60);
  d.iterations = 20;
  const double many = stretch(d, 1.0 / 60), fine = stretch(d, 1.0 / 240);
  EXPECT_GT(few, 3 * many);
  EXPECT_GT(many, 8 * fine);
}

TEST(XpbdValidation, LinksByThemselvesComeToTheSameStretch) {
  // Solved one by one, a sweep leaves an error of (h omega)^2 of the stretch: 1.1 % with 40 substeps, falling
  // with the square of h.
  XpbdDef d = hanging_rope();
  d.sweep = Sweep::links, d.internal_damping = 10;
  d.substeps = 40;
  const double coarse = std::abs(stretch(d, 1.0 / 60) - kStretch);
  d.substeps = 160;
  const double fine = std::abs(stretch(d, 1.0 / 60) - kStretch);
  EXPECT_LT(coarse, 0.05 * kStretch);
  EXPECT_LT(fine, 0.25 * coarse);
}

TEST(XpbdValidation, RopeHangsAsACatenary) {
  for (const auto& [length, sag] :
       {std::pair{1.5, 0.502633261648315168}, std::pair{2.0, 0.796388355860299334}}) {
    for (const Precision precision : {Precision::f64, Precision::f32}) {
      XpbdDef d;
      d.rope = RopeShape{.to = {1, 0, 0}, .links = 100, .length = length};
      d.stiffness = 1e7, d.damping = 0.02, d.internal_damping = 1;
      d.pinned = {"ends"};
      d.precision = precision;
      XpbdRun run(d);
      run.seconds(15);
      // The reference's tolerance for a hundred links.
      EXPECT_NEAR(-run.position(50).y, sag, 1e-3 * sag);
    }
  }
}

TEST(XpbdValidation, YoungsModulusStretchesRopeAndStrip) {
  // u = rho g L^2 / 2 E of a bar under its own weight.
  XpbdDef rope;
  rope.rope = RopeShape{.to = {0, -2, 0}, .links = 40};
  rope.thickness = 0.01, rope.youngs_modulus = 1e7;
  const double area = 3.14159265358979 / 4 * 1e-4;
  rope.density = 1000 * area, rope.pinned = {"first"}, rope.internal_damping = 100;
  XpbdRun bar(rope);
  bar.seconds(5);
  // Half of the last link has no weight on it: 1 / (4 N^2).
  EXPECT_NEAR(-2 - bar.position(40).y, 1000 * 9.81 * 4 / 2e7, 2e-3 * 1000 * 9.81 * 4 / 2e7);

  XpbdDef strip;
  strip.cloth_grid = ClothGridShape{.edge_u = {0.2, 0, 0}, .edge_v = {0, -1, 0}, .nx = 9, .ny = 41};
  strip.thickness = 1e-3, strip.youngs_modulus = 1e6, strip.density = 1;
  strip.pinned = {"edge_v0"}, strip.internal_damping = 5;
  const auto sinks = [&] {
    XpbdRun sheet(strip);
    sheet.seconds(4);
    double low = 0;
    for (size_t i = 0; i < 9; ++i) low -= 1 + sheet.position(40 * 9 + i).y;
    return low / 9;
  };
  // Lines and diagonals pull on the same points, which a sweep solves one after the other: the error is a
  // thousandth of the length, whatever the stretch.
  EXPECT_NEAR(sinks(), 9.81 / 2e3, 1e-3);
  // With many sweeps it is the sheet's own. The clamp holds its width: 2 % of the stretch.
  strip.iterations = 20;
  EXPECT_NEAR(sinks(), 9.81 / 2e3, 0.02 * 9.81 / 2e3);
}

std::array<double, 6> momenta(const XpbdRun& run) {
  std::array<double, 6> out;
  size_t k = 0;
  for (const char* name : {"momentum.x", "momentum.y", "momentum.z", "angular_momentum.x",
                           "angular_momentum.y", "angular_momentum.z"}) {
    out[k++] = run.observe(name);
  }
  return out;
}

/// Largest changes of the linear and of the angular momentum of a body that is kicked at five points, in 2 s.
std::pair<double, double> lost(XpbdDef d, int substeps) {
  d.substeps = substeps;
  XpbdRun run(d, 1.0 / 60, {});
  for (int64_t i = 0; i < 5; ++i) {
    const double s = 0.1 * static_cast<double>(i);
    run.system->apply(run.state, {.kind = CommandKind::impulse, .index = 7 * i, .vector = {s, 0.2 - s, 0.1}});
  }
  const auto start = momenta(run);
  run.seconds(2);
  const auto end = momenta(run);
  double linear = 0, angular = 0;
  for (size_t k = 0; k < 3; ++k) {
    linear = std::max(linear, std::abs(end[k] - start[k]));
    angular = std::max(angular, std::abs(end[k + 3] - start[k + 3]));
  }
  return {linear, angular};
}

TEST(XpbdValidation, FreeBodiesKeepTheirMomenta) {
  XpbdDef cloth, block;
  cloth.cloth_grid = ClothGridShape{.nx = 20, .ny = 20};
  cloth.flexural_rigidity = 1e-3, cloth.internal_damping = 0.01;
  block.block = SoftBlockShape{.cells_x = 3, .cells_y = 3, .cells_z = 3};
  for (const XpbdDef& d : {cloth, block}) {
    const auto [linear, angular] = lost(d, 5);
    const auto [linear_fine, angular_fine] = lost(d, 80);
    // Rounding of ten thousand substeps with 400 points.
    EXPECT_LT(std::max(linear, linear_fine), 1e-10);
    // Directions are those before a correction, velocities those after it, as in implicit Euler: angular
    // momentum is conserved to first order in the substep. That alone would leave a sixteenth; a cloth that
    // buckles differently does not follow the same motion, so a quarter.
    EXPECT_LT(angular_fine, angular / 4);
  }
}

}  // namespace
}  // namespace truestep
