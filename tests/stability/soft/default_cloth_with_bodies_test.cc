// Substeps of scenes of cloth and bodies: those of the scene, or as many as the springs need where bodies are
// touched. (That these hold is in tests/scenes/couplings_long.)
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

TEST(DefaultsWithBodies, WhatASceneSaysCounts) {
  EXPECT_GT(SceneRun(cloth_and_crate(1, "f64")).world->scene().substeps(), 4);
  // Given substeps, and scenes in which nothing touches bodies.
  EXPECT_EQ(SceneRun(cloth_and_crate(1, "f64", R"(, "substeps": 50)")).world->scene().substeps(), 50);
  std::string alone = cloth_and_crate(1, "f64");
  const size_t from = alone.find("\"couplings\""), to = alone.find("\"probes\"");
  alone.erase(from, to - from);
  SceneRun run(alone);
  EXPECT_EQ(run.world->scene().substeps(), 1);
}

}  // namespace
}  // namespace truestep
