// Animated shapes publish solids with velocities: particles, cloth, fluids and rigid bodies meet a moving
// character, each pair once, compared with a wall of that velocity.
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

/// A bone of 1 m along x, 0.05 m thick, that rises at 0.5 m/s from y = 0.
const std::string kBar =
    R"({"type": "skeleton", "id": "bar", "bone_radius": 0.05, "root_position": ["-0.5", "0.5*t", "0"],
        "joints": [{"id": "a", "type": "fixed", "end": [1, 0, 0]}]})";

TEST(AnimatedMeets, ParticlesAreSentOffWithTwiceItsSpeed) {
  SceneRun run(
      R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [)" + kBar +
      R"(, {"type": "particles", "id": "p", "radius": 0.01, "positions": [[0.1, 0.16, 0], [-0.2, 0.2, 0]]}],
      "couplings": [{"type": "contact", "id": "c", "a": "p", "b": "bar", "restitution": 1, "friction": 0}]})");
  run.session.step(400);
  const ConstPoints p(run.session.state().systems[1], *run.world->system(1).ports().points);
  // v' = 2 V - v at a wall of velocity V (restitution 1): exact.
  EXPECT_NEAR(p.velocity(0).y, 1, 1e-9);
  EXPECT_NEAR(p.velocity(1).y, 1, 1e-9);
}

TEST(AnimatedMeets, ASkinSendsParticlesOffToo) {
  SceneRun run(R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [
     {"type": "skeleton", "id": "bar", "root_position": ["-0.5", "0.5*t", "0"], "publish": "skin",
      "joints": [{"id": "a", "type": "fixed", "end": [1, 0, 0]}],
      "skin": {"vertices": [[0, 0.05, -0.2], [1, 0.05, -0.2], [1, 0.05, 0.2], [0, 0.05, 0.2]], "triangles": [0, 2, 1, 0, 3, 2]}},
     {"type": "particles", "id": "p", "radius": 0.01, "positions": [[0.1, 0.16, 0.01]]}],
      "couplings": [{"type": "contact", "id": "c", "a": "p", "b": "bar", "restitution": 1, "friction": 0}]})");
  run.session.step(400);
  const ConstPoints p(run.session.state().systems[1], *run.world->system(1).ports().points);
  EXPECT_NEAR(p.velocity(0).y, 1, 1e-9);
}

TEST(AnimatedMeets, ClothIsCarriedOnIt) {
  // A cloth of 0.4 m hangs over the rising bar: its middle line stays on top of it.
  SceneRun run(
      R"({"time": {"dt": 0.005, "substeps": 10}, "systems": [)" + kBar +
      R"(, {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-0.2, 0.08, -0.2], "edge_u": [0.4, 0, 0], "edge_v": [0, 0, 0.4], "nx": 9, "ny": 9},
       "mass": 0.001, "stiffness": 200, "internal_damping": 0.02, "damping": 0.001, "thickness": 0.01, "integrator": "velocity_verlet"}],
      "couplings": [{"type": "contact", "id": "c", "a": "cloth", "b": "bar", "friction": 0.6}]})");
  run.session.step(120);
  const Vec3 middle = load3(run.session.state().systems[1].f64(0).data(), 4 * 9 + 4);
  // The bar's axis is at 0.3 m, its skin 0.05 m and half of the cloth 0.005 m higher; a cloth of springs
  // sinks between its points by less than its thickness.
  EXPECT_NEAR(middle.y, 0.3 + 0.05 + 0.005, 0.01);
  EXPECT_LT(run.observe("c.penetration"), 1e-3);
}

TEST(AnimatedMeets, RigidBodiesAreCarriedByTheBodiesOnBones) {
  // rigid3d meets a character through bodies carried by its bones (ragdoll, never released): a ball rests on
  // a rising bar and is at rest relative to it.
  SceneRun run(R"({"time": {"dt": 0.005}, "systems": [)" + kBar +
               R"(, {"type": "rigid3d", "id": "world", "bodies": [
      {"type": "box", "half_extents": [0.5, 0.05, 0.3], "position": [0, 0, 0], "mass": 5},
      {"type": "sphere", "radius": 0.1, "position": [0.1, 0.151, 0], "mass": 1, "velocity": [0, 0.5, 0]}]}],
      "couplings": [{"type": "ragdoll", "id": "r", "a": "bar", "b": "world", "bones": [0], "bodies": [0]}]})");
  run.session.step(200);
  const ConstBodies b(run.session.state().systems[1], *run.world->system(1).ports().bodies);
  EXPECT_NEAR(b.place(0).y, 0.5, 1e-9);
  // On top of it: 0.05 + 0.1 m; contacts give way by less than a millimetre under a kilogram.
  EXPECT_NEAR(b.place(1).y, 0.5 + 0.15, 2e-3);
  // Within its step the carried body is as free as others: it falls g h = 0.049 m/s, and the ball's weight on
  // it adds a fifth of that.
  EXPECT_NEAR(b.velocity(1).y, 0.5, 1.1 * 9.81 * 0.005 * (1 + 1.0 / 5));
}

TEST(AnimatedMeets, WaterMakesRoomForABone) {
  // A bone of 6.2 litres is lowered into a basin of 0.16 m^2: the water rises by 39 mm. The control: the bone
  // stays above.
  const auto level = [](const std::string& way) {
    SceneRun run(R"({"time": {"dt": 0.004}, "systems": [
      {"type": "skeleton", "id": "bar", "bone_radius": 0.08, "root_position": ["0.1", ")" +
                 way + R"(", "0.2"],
        "joints": [{"id": "a", "type": "fixed", "end": [0.2, 0, 0]}]},
      {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.4, 1, 0.4], "spacing": 0.04,
       "bodies": [{"center": [0.2, 0.15, 0.2], "half_extents": [0.2, 0.15, 0.2]}]}],
      "couplings": [{"type": "immersion", "id": "i", "a": "bar", "b": "water", "bodies": "all"}]})");
    run.session.step(150);
    const State& s = run.session.state().systems[1];
    const auto medium = *run.world->system(1).ports().medium;
    const RealColumn<const double> x(s, medium.place);
    // Twice the mean height of the water: the level, for an evenly filled basin.
    double sum = 0;
    for (size_t k = 0; k < s.rows(medium.place); ++k) sum += x.vector(k).y;
    return 2 * sum / static_cast<double>(s.rows(medium.place));
  };
  // It hangs in the upper half: the displaced water moves up, so that the mean height rises by more than a
  // third of the level's 39 mm.
  EXPECT_GT(level("0.5 - 0.6*min(t, 0.5)"), level("0.5") + 0.013);
}

}  // namespace
}  // namespace truestep
