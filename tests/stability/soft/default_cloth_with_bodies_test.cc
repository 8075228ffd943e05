// Scenes of cloth and ropes that touch bodies and name neither methods nor substeps: the defaults hold.
#include <string_view>

#include "engine/integrators/table/integrators.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

std::string cloth_and_crate(double mass, const char* precision, const char* more = "") {
  char text[1500];
  std::snprintf(text, sizeof text, R"({"time": {"dt": 0.016666666666666666%s}, "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-1, 1, -1], "edge_u": [2, 0, 0],
        "edge_v": [0, 0, 2], "nx": 15, "ny": 15}, "mass": 0.004, "stiffness": 2000, "shear_stiffness": 500,
        "pinned": ["border"], "thickness": 0.02, "damping": 0.01},
      {"type": "rigid3d", "id": "bodies", "precision": "%s", "bodies": [{"type": "box", "id": "crate",
        "half_extents": [0.2, 0.2, 0.2], "position": [0.1, 1.5, 0], "axis": [1, 0.3, 0.2], "angle": 0.4,
        "mass": %g}]}],
    "couplings": [{"type": "contact", "id": "catch", "a": "cloth", "b": "bodies", "friction": 0.5}],
    "probes": [{"id": "crate", "system": "bodies", "index": 0, "fields": ["position"]}]})",
                more, precision, mass);
  return text;
}

TEST(DefaultsWithBodies, ClothHoldsLightAndHeavyCrates) {
  for (const char* precision : {"f32", "f64"}) {
    for (const double mass : {0.1, 1.0, 10.0}) {
      SceneRun run(cloth_and_crate(mass, precision));
      EXPECT_EQ(run.world->system(0).integration().method->name, "velocity_verlet");
      EXPECT_GT(run.world->scene().substeps(), 4);
      const double start = run.observe("energy.total"), drop = mass * 9.81 * 0.5;
      double highest = start;
      const int seconds = mass == 1 && precision == std::string_view("f64") ? 60 : 10;
      for (int k = 0; k < 60 * seconds; ++k) {
        ASSERT_TRUE(run.session.step(1)) << mass << " " << precision << " " << k;
        if (k % 30 != 0) continue;
        highest = std::max(highest, run.observe("energy.total"));
        // A body may roll off the corner of a cloth, but not pass through its middle.
        ASSERT_LT(run.observe("catch.penetration"), 1e-4) << mass << " " << precision << " " << k;
      }
      // Rounding and the oscillation of a symplectic method's energy in the springs: far below the energy of
      // the fall.
      EXPECT_LT(highest, start + 0.01 * drop) << mass << " " << precision;
      EXPECT_GT(run.observe("crate.position.y"), 0.2) << mass << " " << precision;
      // It has come to rest on the cloth: the impulse on the crate equals its weight times the time.
      EXPECT_NEAR(run.observe("catch.impulse.y"), mass * 9.81 * seconds, 0.03 * mass * 9.81 * seconds)
          << mass;
    }
  }
}

// The control: with whole steps the same springs fly apart, and this is reported.
TEST(DefaultsWithBodies, WholeStepsDoNot) {
  SceneRun run(cloth_and_crate(1, "f64", R"(, "substeps": 1)"));
  EXPECT_EQ(run.world->scene().substeps(), 1);
  run.session.step(120);
  EXPECT_TRUE(run.session.failure().has_value());
}

TEST(DefaultsWithBodies, WhatASceneSaysCounts) {
  // Given substeps, named methods, and scenes in which nothing touches bodies.
  EXPECT_EQ(SceneRun(cloth_and_crate(1, "f64", R"(, "substeps": 50)")).world->scene().substeps(), 50);
  std::string alone = cloth_and_crate(1, "f64");
  const size_t from = alone.find("\"couplings\""), to = alone.find("\"probes\"");
  alone.erase(from, to - from);
  SceneRun run(alone);
  EXPECT_EQ(run.world->scene().substeps(), 1);
  EXPECT_EQ(run.world->system(0).integration().method->name, "linear_implicit_euler");
}

}  // namespace
}  // namespace truestep
