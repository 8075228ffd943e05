// The material point method at extremes: fast impacts, soft and stiff materials, and a refusal that names the
// fault.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

MpmDef thrown(Law law, double speed, double e) {
  MpmDef d;
  d.cell = 0.05;
  BodyDef b;
  b.center = {0.5, 0.4, 0}, b.half_extents = {0.15, 0.15, 1}, b.velocity = {0, -speed, 0};
  b.material = law, b.youngs_modulus = e, b.bulk_modulus = e;
  d.bodies = {b};
  return d;
}

// Spurious energy: a tenth is the oscillation of explicit steps at half their limit.
TEST(MpmStability, AnImpactAtFiftyMetresASecondAddsNoEnergy) {
  for (const Law law : {Law::fluid, Law::corotated, Law::neo_hookean, Law::snow, Law::sand, Law::foam}) {
    MpmRun run(thrown(law, 50, 1e5), 1.0 / 240);
    const double start = run.observe("energy.kinetic");
    for (int k = 0; k < 24; ++k) {
      run.step();
      EXPECT_FALSE(run.state.first_bad(1e4, State::Look::everything)) << static_cast<int>(law);
      EXPECT_LT(run.observe("energy.kinetic"), 1.1 * start) << static_cast<int>(law);
    }
    EXPECT_GE(run.observe("low.y"), 0);
  }
}

TEST(MpmStability, AnyModulusHoldsWithTheSubstepsItAsksFor) {
  for (const double e : {1e3, 1e5, 1e7, 1e9}) {
    MpmRun run(thrown(Law::corotated, 1, e), 1.0 / 240, {0, -9.81, 0});
    const double start = run.observe("energy.total");
    for (int k = 0; k < 12; ++k) run.step();
    EXPECT_FALSE(run.state.first_bad(100, State::Look::everything)) << e;
    EXPECT_LT(run.observe("energy.total"), start + 0.1 * std::abs(start)) << e;
  }
}

// The same with implicit steps, for solids whose waves would cross 500 cells per step: backward Euler removes
// energy.
TEST(MpmStability, AStiffImpactByImplicitStepsAddsNoEnergy) {
  for (const Law law : {Law::corotated, Law::neo_hookean}) {
    for (const Contact contact : {Contact::separate, Contact::sticky, Contact::slip}) {
      MpmDef d = thrown(law, 50, 1e9);
      d.integration = Integration::implicit_steps, d.precision = Precision::f64, d.walls = contact;
      MpmRun run(d, 1.0 / 60, {0, -9.81, 0});
      double last = run.observe("energy.total");
      const double start = last;
      for (int k = 0; k < 4; ++k) {
        run.step();
        ASSERT_FALSE(run.state.first_bad(1e4, State::Look::everything)) << static_cast<int>(law);
        // Newton's method ends at velocities within a millionth.
        EXPECT_LT(run.observe("energy.total"), last + 1e-4 * start) << static_cast<int>(law);
        last = run.observe("energy.total");
      }
      EXPECT_GE(run.observe("low.y"), 0);
    }
  }
}

// Pressed to a tenth of its height and released: the stored energy becomes kinetic, and none is created. A
// fluid's pressure there is a million times its modulus; it may need more substeps than are allowed.
TEST(MpmStability, WhatIsPressedToATenthComesBackOrIsRefused) {
  for (const Law law : {Law::fluid, Law::corotated, Law::neo_hookean, Law::snow, Law::sand, Law::foam}) {
    MpmDef d = thrown(law, 0, 1e5);
    d.high = {1, 4, 1};
    MpmRun run(d, 1.0 / 2000);
    const auto x = run.state.span<float>(columns::position), f = run.state.span<float>(columns::deformation),
               j = run.state.span<float>(columns::jacobian);
    for (size_t i = 0; i < j.size(); ++i)
      x[3 * i + 1] = 0.1f * (x[3 * i + 1] - 0.25f), f[4 * i + 3] = 0.1f, j[i] = 0.1f;
    const double start = run.observe("energy.total");
    try {
      for (int k = 0; k < 20; ++k) {
        run.step();
        ASSERT_FALSE(run.state.first_bad(1e4, State::Look::everything)) << static_cast<int>(law);
        // A tenth is what explicit steps at half their limit swing by.
        EXPECT_LT(run.observe("energy.total"), 1.1 * start) << static_cast<int>(law);
      }
      EXPECT_GT(run.observe("high.y"), 0.035) << "it has grown from 3 cm: " << static_cast<int>(law);
    } catch (const Instability& refused) {
      EXPECT_EQ(law, Law::fluid) << refused.what();
    }
  }
}

// A minute on the floor: it neither creeps nor heats up. Its own weight compresses jelly by half a per cent
// of its height; there is no sideways force, so that only rounding of f32 positions over 35,000 substeps is
// left.
TEST(MpmStability, WhatLiesStillStaysForAMinute) {
  for (const Law law : {Law::corotated, Law::sand}) {
    MpmDef d = thrown(law, 0, 1e5);
    d.bodies[0].center = {0.5, 0.15, 0}, d.wall_friction = 0.5;
    MpmRun run(d, 1.0 / 60, {0, -9.81, 0});
    run.seconds(5);
    const double x = run.observe("centre.x"), y = run.observe("centre.y");
    run.seconds(55);
    EXPECT_NEAR(run.observe("centre.x"), x, 1e-3 * d.cell) << static_cast<int>(law);
    EXPECT_NEAR(run.observe("centre.y"), y, 1e-2 * d.cell) << static_cast<int>(law);
    EXPECT_LT(run.observe("energy.kinetic"), 1e-6 * 90 * 9.81 * 0.15) << static_cast<int>(law);
  }
}

TEST(MpmStability, TooManySubstepsAreRefusedByName) {
  MpmDef d = thrown(Law::corotated, 1, 1e9);
  d.max_substeps = 10;
  MpmRun run(d, 1.0 / 60);
  try {
    run.step();
    FAIL() << "no refusal";
  } catch (const Instability& failure) {
    EXPECT_NE(std::string(failure.what()).find("max_substeps"), std::string::npos);
    EXPECT_GT(failure.suggested_dt, 0);
  }
  d.max_substeps = 10'000;
  MpmRun enough(d, 1.0 / 60);
  EXPECT_NO_THROW(enough.step());
}

}  // namespace
}  // namespace truestep::mpm
