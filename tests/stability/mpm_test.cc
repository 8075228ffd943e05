// The material point method at extremes: fast impacts, soft and stiff materials, and a refusal that names
// what is wrong.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/unit/mpm_rig.h"

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

// Energy that nothing brought in: a tenth is what explicit steps at half their limit swing by.
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
