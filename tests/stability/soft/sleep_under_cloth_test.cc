// Cloth that lies on a crate no longer keeps it awake: the crate falls asleep under it and sleeps on, until
// the cloth is thrown onto it or pressed down.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/session/world/world.h"

namespace truestep {
namespace {

/// A crate of 500 kg and a cloth of 1.6 kg, `above` it by this distance (m).
struct Covered {
  explicit Covered(double above)
      : world(parse_scene(
            R"({"systems": [{"type": "rigid3d", "id": "crates", "bodies": [{"type": "plane", "motion": "fixed"},
      {"type": "box", "half_extents": [0.5, 0.5, 0.5], "position": [0, 0.5, 0], "density": 500}]},
    {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-0.6, )" +
            std::to_string(1.01 + above) + R"(, -0.6], "edge_u": [1.2, 0, 0], "edge_v": [0, 0, 1.2],
      "nx": 9, "ny": 9}, "mass": 0.02, "stiffness": 500, "shear_stiffness": 100, "damping": 0.05,
      "internal_damping": 1, "thickness": 0.02}],
    "couplings": [{"type": "contact", "a": "cloth", "b": "crates"}]})")),
        state(world.initial_state()) {}
  /// Fewest and most bodies awake over these steps.
  std::pair<double, double> awake(int steps) {
    double least = 2, most = 0;
    for (int k = 0; k < steps; ++k) {
      world.step(state, workspace, arena, {});
      const double now = world.observe(state).find("crates.awake").value();
      least = std::min(least, now), most = std::max(most, now);
    }
    return {least, most};
  }
  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

TEST(SleepUnderCloth, ACrateSleepsOnUnderWhatLiesOnIt) {
  Covered lies(0);
  EXPECT_EQ(lies.awake(120).first, 0) << "it falls asleep";
  EXPECT_EQ(lies.awake(60).second, 0) << "and sleeps on";
}

TEST(SleepUnderCloth, ABlowWakesIt) {
  Covered falls(1);
  // It sleeps after half a second; the cloth needs more, slowed down by the air.
  EXPECT_EQ(falls.awake(33), std::pair(0.0, 1.0));
  EXPECT_EQ(falls.awake(40).second, 1) << "2 m/s wake it";
  EXPECT_EQ(falls.awake(120).first, 0) << "and it sleeps again";
}

TEST(SleepUnderCloth, AnotherLoadWakesIt) {
  Covered lies(0);
  lies.awake(120);
  ASSERT_EQ(lies.awake(1).second, 0);
  const auto press = [&](double force) {
    Command c;
    c.kind = CommandKind::push, c.system = "cloth", c.index = 40, c.vector = {0, -force, 0}, c.duration = 0.2;
    lies.world.apply(lies.state, c);
    return lies.awake(6).second;
  };
  // 0.1 m/s^2 of 500 kg are 50 N.
  EXPECT_EQ(press(5), 0);
  EXPECT_EQ(press(200), 1);
}

}  // namespace
}  // namespace truestep
