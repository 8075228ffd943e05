// Iterations of inverse kinematics solvers on the chain of ten joints on which Aristidou and Lasenby (2011)
// compare them, and skins, feet and cloth in whole scenes.
#include "tests/support/coupled.h"
#include "tests/unit/animation/animation_rig.h"

namespace truestep::animation {
namespace {

using testing_rig::Chain;

double mean_iterations(IkMethod method, int most) {
  std::mt19937 engine(41);
  double sum = 0;
  constexpr int kTargets = 200;
  for (int k = 0; k < kTargets; ++k) {
    Chain chain(10, 1), other(10, 1);
    // Targets reached by some pose of the chain; the start is a slightly bent chain.
    other.shake(engine, 1.2);
    chain.shake(engine, 0.1);
    const Vec3 target = other.place();
    sum += chain.solve(chain.goal(target), {.method = method, .tolerance = 0.01, .most = most}).iterations;
  }
  return sum / kTargets;
}

// anim.fabrik_table: FABRIK 15.461 iterations, CCD 26.308, damped least squares 998.648 on average. The paper
// gives neither its targets nor its tolerance in full; here, iterations to a hundredth of a link, at most
// twice as many (the required factor of 2), and in the published order. Our adaptive damping needs far fewer
// than the paper's fixed one.
TEST(InverseKinematicsTable, IterationsAreNotMoreThanTwiceThePublishedOnes) {
  const double fabrik = mean_iterations(IkMethod::fabrik, 1000), ccd = mean_iterations(IkMethod::ccd, 1000);
  const double damped = mean_iterations(IkMethod::damped_least_squares, 5000);
  const double gradient = mean_iterations(IkMethod::gradient, 20000);
  RecordProperty("fabrik", std::to_string(fabrik));
  RecordProperty("ccd", std::to_string(ccd));
  RecordProperty("damped", std::to_string(damped));
  RecordProperty("gradient", std::to_string(gradient));
  std::printf("fabrik %.2f ccd %.2f damped %.2f gradient %.2f\n", fabrik, ccd, damped, gradient);
  EXPECT_LT(fabrik, 2 * 15.461);
  EXPECT_LT(ccd, 2 * 26.308);
  EXPECT_LT(damped, 2 * 998.648);
  EXPECT_LT(gradient, 2 * 1311.19);
  // The control: the tolerance requires iterations.
  EXPECT_GT(fabrik, 1);
}

TEST(AnimationScenes, AMovingBallCarriesAClothUp) {
  // A sphere of keyframes rises at 0.5 m/s under a cloth: contacts know its motion.
  testing_coupled::SceneRun run(R"({"time": {"dt": 0.005, "substeps": 10}, "systems": [
    {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-0.5, 0.4, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 15, "ny": 15},
     "mass": 0.001, "stiffness": 200, "internal_damping": 0.02, "damping": 0.001, "thickness": 0.02, "integrator": "velocity_verlet"},
    {"type": "keyframes", "id": "ball", "shapes": [{"id": "b", "radius": 0.3, "position": ["0", "0.5*t", "0"]}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "cloth", "b": "ball", "friction": 0.8}]})");
  double deepest = 0;
  for (int k = 0; k < 160; ++k) {
    run.session.step(1);
    deepest = std::max(deepest, run.observe("c.penetration"));
  }
  // A thousandth of the thickness: touches are swept a limited number of times.
  EXPECT_LT(deepest, 1e-5);
  const double* x = run.session.state().systems[0].f64(0).data();
  const Vec3 middle = load3(x, 7 * 15 + 7);
  // The middle lies on the top of the ball, 0.3 m above its centre at 0.4 m, half a thickness away.
  EXPECT_NEAR(middle.y, 0.4 + 0.3 + 0.01, 0.02);
}

TEST(AnimationScenes, ParticlesMeetABoneThatSwings) {
  // A bat that swings at 4 rad/s hits balls at rest without gravity, 0.5 m from its joint: by Newton's law
  // with restitution 1, a wall that moves at v sends them off at 2 v = 4 m/s along its normal.
  testing_coupled::SceneRun run(R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [
    {"type": "skeleton", "id": "bat", "bone_radius": 0.02, "joints": [{"id": "hand", "type": "revolute", "value": "4*t", "end": [1, 0, 0]}]},
    {"type": "particles", "id": "balls", "radius": 0.01, "positions": [[0.49, 0.1, 0]]}],
    "couplings": [{"type": "contact", "id": "c", "a": "balls", "b": "bat", "restitution": 1, "friction": 0}]})");
  run.session.step(200);
  const State& s = run.session.state().systems[1];
  const Ports ports = run.world->system(1).ports();
  const Vec3 v = ConstPoints(s, *ports.points).velocity(0);
  // 2 w r with r = 0.5 m, to the step in which it is hit (4 mrad) and the bat's thickness.
  EXPECT_NEAR(norm(v), 4, 0.1);
  EXPECT_GT(v.y, 3.8);
}

TEST(AnimationScenes, AControlDrivesAParameter) {
  // The drag of a pendulum grows as 2 t.
  testing_coupled::SceneRun run(R"scene({"time": {"dt": 0.001}, "systems": [
    {"type": "keyframes", "id": "keys", "controls": [{"name": "g", "value": "2*t"}]},
    {"type": "pendulum", "id": "bob", "angle": 0.3, "damping": 0.1}],
    "couplings": [{"type": "drive", "id": "d", "a": "keys", "b": "bob", "control": "g", "parameter": "damping"}]})scene");
  run.session.step(500);
  EXPECT_NEAR(run.observe("d.value"), 2 * 0.499, 1e-12) << "at the start of the last step";
  const State& s = run.session.state().systems[1];
  EXPECT_NEAR(s.f64(s.at("damping"))[0], 2 * 0.499, 1e-12);
}

TEST(AnimationScenes, ADriveOutOfBoundsEndsTheRun) {
  testing_coupled::SceneRun run(R"scene({"time": {"dt": 0.01}, "systems": [
    {"type": "keyframes", "id": "keys", "controls": [{"name": "g", "value": "0.1 - t"}]},
    {"type": "pendulum", "id": "bob", "angle": 0.3, "damping": 0.1}],
    "couplings": [{"type": "drive", "id": "d", "a": "keys", "b": "bob", "control": "g", "parameter": "damping"}]})scene");
  run.session.step(10);
  EXPECT_THROW(run.session.step(5), Instability) << "the drag would be negative";
}

}  // namespace
}  // namespace truestep::animation
