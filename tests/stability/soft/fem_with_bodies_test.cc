// A crate on a block of finite elements in a scene that names neither methods nor substeps: the defaults
// hold.
#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

std::string block_and_crate(const char* method) {
  char text[1200];
  std::snprintf(text, sizeof text, R"({"time": {"dt": 0.016666666666666666}, "systems": [
      {"type": "fem", "id": "block", "block": {"origin": [-0.5, 0, -0.5], "size": [1, 0.4, 1], "cells_x": 6,
        "cells_y": 3, "cells_z": 6}, "material": "stable_neo_hookean", "youngs_modulus": 5e4,
        "pinned": ["bottom"], "damping": 2%s},
      {"type": "rigid3d", "id": "bodies", "bodies": [{"type": "box", "half_extents": [0.2, 0.2, 0.2],
        "position": [0.03, 0.9, 0], "mass": 20}]}],
    "couplings": [{"type": "contact", "id": "touch", "a": "block", "b": "bodies", "friction": 0.5}]})",
                method);
  return text;
}

TEST(FemWithBodies, ABlockCarriesACrateAtDefaults) {
  SceneRun run(block_and_crate(""));
  EXPECT_EQ(run.world->system(0).integration().method->name, "velocity_verlet");
  EXPECT_GT(run.world->scene().substeps(), 1);
  constexpr int kSeconds = 20;
  constexpr double kWeight = 20 * 9.81;
  // The crate's fall; the energy released while the block sags under its own weight is gravity's as well, and
  // stays within the total.
  const double start = run.observe("energy.total"), drop = kWeight * 0.3;
  double highest = start;
  for (int k = 0; k < 60 * kSeconds; ++k) {
    ASSERT_TRUE(run.session.step(1)) << k;
    if (k % 20 != 0) continue;
    highest = std::max(highest, run.observe("energy.total"));
    ASSERT_LT(run.observe("touch.penetration"), 1e-6) << k;
  }
  EXPECT_LT(highest, start + 0.01 * drop);
  EXPECT_NEAR(run.observe("touch.impulse.y"), kWeight * kSeconds, 0.03 * kWeight * kSeconds);
}

// The control: a method that solves for all nodes together is refused, with advice.
TEST(FemWithBodies, NamedImplicitMethodsAreRefused) {
  try {
    SceneRun run(block_and_crate(R"(, "integrator": "implicit_euler")"));
    FAIL();
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/couplings/0/a");
  }
}

}  // namespace
}  // namespace truestep
