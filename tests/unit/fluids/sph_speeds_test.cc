// The speeds that a liquid is prepared for: the sound of wcsph and the substeps follow from the start,
// nozzles, moving walls, and the fall from there.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/systems/sph/speeds.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;
constexpr Vec3 kFall{0, -9.81, 0};

/// Sixty particles from a nozzle onto the floor of a box.
SphDef puddle() {
  SphDef d;
  d.dimension = 2, d.high = {0.8, 0.8, 0}, d.spacing = 0.03, d.solver = Method::wcsph;
  d.precision = Precision::f64, d.max_particles = 60;
  InletDef e;
  e.position = {0.25, 0.5, 0}, e.direction = {1, 0.3, 0}, e.radius = 0.1, e.speed = 2, e.stop = 2;
  d.emitters = {e};
  return d;
}

MotionDef to_and_fro(double amplitude, double frequency) {
  MotionDef m;
  m.amplitude = {amplitude, 0, 0}, m.frequency = frequency;
  return m;
}
BoxColliderDef piston(const MotionDef& motion) {
  BoxColliderDef c;
  c.center = {0.05, 0.4, 0}, c.half_extents = {0.05, 0.4, 1}, c.motion = motion;
  return c;
}

/// The puddle after 2 s, and the one warning about it, if any.
struct Settled {
  double error, depth;
  std::string warning;
};
Settled settled(const SphDef& d) {
  SphRun run(d, 1.0 / 60, kFall);
  run.seconds(2);
  std::vector<Warning> warnings;
  run.system.warn(run.state, 1.0 / 60, warnings);
  return {run.observe("density.mean_error"), run.observe("centre.y"),
          warnings.empty() ? "" : warnings[0].detail};
}

// Fed by a nozzle alone, wcsph had a sound speed of 1e-6 m/s and no pressure: its particles lay on the floor
// in one row, and the warning named 1.1e-5 m/s.
TEST(SphSpeeds, ALiquidFromNozzlesHasPressure) {
  const Settled found = settled(puddle());
  // What a pool of the same volume is off by: under the warning's 1 %.
  EXPECT_LT(found.error, 0.01);
  EXPECT_EQ(found.warning, "");
  // 60 particles on a floor 27 spacings wide: 2.25 layers, on average 1.1 spacings high; in one row a
  // quarter.
  EXPECT_GT(found.depth, 0.9 * 0.03);

  // The control: without pressure all of it lies in one row, and the warning names a sound that does.
  SphDef d = puddle();
  d.sound_speed = 1e-6;
  const Settled fallen = settled(d);
  EXPECT_GT(fallen.error, 0.5);
  EXPECT_LT(fallen.depth, 0.5 * 0.03);
  const std::string word = "a sound_speed of ";
  const size_t at = fallen.warning.find(word);
  ASSERT_NE(at, std::string::npos) << fallen.warning;
  d.sound_speed = std::stod(fallen.warning.substr(at + word.size()));
  EXPECT_EQ(settled(d).warning, "");
}

TEST(SphSpeeds, TheFastestOfAllCountsAndTheFallFromTheHighest) {
  SphDef d = puddle();
  const auto expected = [&] {
    return expected_speed(d, build_colliders_but_solids(d.colliders), {}, kFall, 0);
  };
  // From the nozzle's upper edge to the floor.
  EXPECT_NEAR(expected(), std::sqrt(4 + 2 * 9.81 * 0.6), 1e-12);
  d.kill_planes = {{.point = {0, 0.2, 0}}};
  EXPECT_NEAR(expected(), std::sqrt(4 + 2 * 9.81 * 0.4), 1e-12) << "no deeper than to where particles end";
  d.kill_planes[0].normal = {0, -1, 0};
  EXPECT_NEAR(expected(), std::sqrt(4 + 2 * 9.81 * 0.6), 1e-12) << "control: a ceiling";
  d.colliders = {piston(to_and_fro(0.1, 10))};
  const double swing = 2 * 3.14159265358979323846;
  EXPECT_NEAR(expected(), std::sqrt(swing * swing + 2 * 9.81 * 0.6), 1e-12) << "a piston at 2 pi f a";
  d.colliders = {piston({})};
  EXPECT_NEAR(expected(), std::sqrt(4 + 2 * 9.81 * 0.6), 1e-12) << "control: one at rest";
  // The same box lying on its side.
  const double aside = expected_speed(d, build_colliders_but_solids(d.colliders), {}, {9.81, 0, 0}, 0);
  EXPECT_NEAR(aside, std::sqrt(4 + 2 * 9.81 * (0.8 - 0.25 + 0.1)), 1e-12);
}

// A piston of 6.3 m/s crossed two spacings per substep.
TEST(SphSpeeds, AMovingWallCrossesNoMoreThanItsPartOfASpacing) {
  SphDef d;
  d.dimension = 2, d.high = {0.8, 0.8, 0}, d.spacing = 0.03;
  d.bodies = {{.center = {0.6, 0.15, 0}, .half_extents = {0.2, 0.15, 1}}};
  const auto substeps = [&](Method solver, const MotionDef& motion) {
    d.solver = solver, d.colliders = {piston(motion)};
    SphRun run(d, 1.0 / 60, kFall);
    run.step();
    return run.observe("substeps");
  };
  const MotionDef fast = to_and_fro(0.1, 10);
  const double least = 2 * 3.14159265358979323846 / 60 / (0.4 * 0.03);
  for (const Method solver : {Method::dfsph, Method::pbf}) {
    EXPECT_GE(substeps(solver, fast), least);
    EXPECT_LT(substeps(solver, {}), least) << "control: one at rest";
  }
  MotionDef gone = fast;
  gone.velocity = {-1000, 0, 0}, gone.amplitude = {};
  d.solver = Method::dfsph, d.colliders = {piston(gone)};
  SphRun run(d, 1.0 / 60, kFall);
  run.steps = 60;
  run.step();
  EXPECT_LT(run.observe("substeps"), least) << "control: one that has left";
}

}  // namespace
}  // namespace truestep::sph
