// Couplings against closed forms: normal modes of attached bodies, collisions of two bodies.
#include <cmath>
#include <numbers>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// Two free masses on a spring: omega^2 = k (1/m1 + 1/m2) (Landau, Lifshitz, Mechanics, section 13 and 21).
// One system is a network, the other particles; released 10 % stretched, after half a period the length is
// the mirror image, and the error falls with the square of the step.
double half_period_error(double h) {
  const double m1 = 0.3, m2 = 0.7, k = 50, omega = std::sqrt(k * (1 / m1 + 1 / m2));
  const auto steps = static_cast<uint64_t>(std::llround(std::numbers::pi / omega / h));
  const double dt = std::numbers::pi / omega / static_cast<double>(steps);
  char scene[1024];
  std::snprintf(scene, sizeof scene, R"({"gravity": [0, 0, 0], "time": {"dt": %.17g}, "systems": [
      {"type": "mass_spring", "id": "a", "free": {"points": [[0, 0, 0]], "masses": [%g]}, "integrator": "leapfrog"},
      {"type": "particles", "id": "b", "positions": [[1.1, 0, 0]], "masses": [%g]}],
    "couplings": [{"type": "attachment", "a": "a", "b": "b", "stiffness": %g, "rest_length": 1}],
    "probes": [{"id": "p", "system": "a"}, {"id": "q", "system": "b"}]})",
                dt, m1, m2, k);
  SceneRun run(scene);
  run.session.step(steps);
  // At the turning point the length's error is of second order in that of the period: look at the speed.
  const double speed = run.session.observe().find("p.position.x").value();
  const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
  const ConstPoints q(run.session.state().systems[1], *run.world->system(1).ports().points);
  EXPECT_NEAR(q.x[0] - speed, 0.9, 1e-3);
  return std::abs(q.v[0] - p.v[0]) / (0.1 * omega);
}

TEST(CouplingValidation, AttachedBodiesSwingWithTheirNormalMode) {
  // Kicks and drifts: the phase after half a period is off by pi (h omega)^2 / 24 (leapfrog's frequency).
  const double omega = std::sqrt(50 * (1 / 0.3 + 1 / 0.7));
  const double coarse = half_period_error(0.005), fine = half_period_error(0.0025);
  EXPECT_NEAR(coarse, std::numbers::pi * 0.005 * omega * 0.005 * omega / 24, 0.05 * coarse);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
  // The control: the same check without the reduced mass misses by half.
  EXPECT_GT(std::abs(std::sqrt(50 / 0.3) - omega), 0.1 * omega);
}

// A particle on a rigid link to a pinned point is a pendulum: T = 4 K(sin(theta0 / 2)) sqrt(L / g) with the
// complete elliptic integral (Landau, Lifshitz, Mechanics, section 11); theta0 = 90 degrees, K
// = 1.854074677301372.
double pendulum_error(uint64_t steps) {
  const double period = 4 * 1.854074677301372 * std::sqrt(1 / 9.81);
  char scene[1024];
  std::snprintf(scene, sizeof scene, R"({"time": {"dt": %.17g}, "systems": [
      {"type": "mass_spring", "id": "pin", "free": {"points": [[0, 0, 0]]}, "pins": [0]},
      {"type": "particles", "id": "bob", "positions": [[1, 0, 0]], "integrator": "velocity_verlet"}],
    "couplings": [{"type": "attachment", "a": "pin", "b": "bob", "link": "rigid"}],
    "probes": [{"id": "bob", "system": "bob"}]})",
                0.25 * period / static_cast<double>(steps));
  SceneRun run(scene);
  run.session.step(steps);
  // A quarter of a period after the release it passes the bottom.
  return std::abs(run.observe("bob.position.x"));
}

TEST(CouplingValidation, RigidLinkMakesAPendulumOfSecondOrder) {
  const double coarse = pendulum_error(200), fine = pendulum_error(400);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

// A ball (particle) meets a mass on a spring (network) head on: velocities after the impact from momentum and
// Newton's e (Landau, Lifshitz, Mechanics, section 17): v1' = (m1 - e m2) v / (m1 + m2), v2' = m1 (1 + e) v /
// (m1 + m2); afterwards the mass swings with amplitude v2' / omega about its rest.
TEST(CouplingValidation, BallHitsAMassOnASpring) {
  for (const double e : {1.0, 0.6, 0.0}) {
    const double m1 = 0.2, m2 = 0.5, v = 1.5, k = 20, omega = std::sqrt(k / m2);
    char scene[1536];
    std::snprintf(scene, sizeof scene, R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [
        {"type": "mass_spring", "id": "m", "free": {"points": [[0, 0, 0], [1, 0, 0]], "masses": [%g, 1],
          "springs": [{"a": 0, "b": 1, "stiffness": %g}]}, "pins": [1], "thickness": 0.1, "integrator": "yoshida4"},
        {"type": "particles", "id": "ball", "mass": %g, "radius": 0.05, "positions": [[-0.4, 0, 0]],
         "velocities": [[%g, 0, 0]]}],
      "couplings": [{"type": "contact", "id": "c", "a": "ball", "b": "m", "restitution": %g, "rest_speed": 0}],
      "probes": [{"id": "m", "system": "m", "fields": ["position", "velocity"]},
                 {"id": "ball", "system": "ball", "fields": ["position", "velocity"]}]})",
                  m2, k, m1, v, e);
    SceneRun run(scene);
    double after1 = v, after2 = 0;
    while (run.observe("c.impulse.sum") == 0 && run.session.step_index() < 1000) run.session.step(1);
    after1 = run.observe("ball.velocity.x");
    after2 = run.observe("m.velocity.x");
    EXPECT_NEAR(after1, (m1 - e * m2) * v / (m1 + m2), 1e-12) << e;
    // The spring has acted for part of a step: omega^2 x h with x = v h.
    const double impact = m1 * (1 + e) * v / (m1 + m2);
    EXPECT_NEAR(after2, impact, omega * omega * impact * 1e-6) << e;
    EXPECT_NEAR(run.observe("c.impulse.x"), m2 * impact, 1e-12) << e;
    const double reduced = m1 * m2 / (m1 + m2);
    EXPECT_NEAR(run.observe("c.energy.lost"), 0.5 * reduced * v * v * (1 - e * e), 1e-12) << e;
    // With e = 1 the ball flies away and the mass swings alone: its turning point is v2' / omega.
    if (e < 1) continue;
    double farthest = 0;
    for (int i = 0; i < 400; ++i) {
      run.session.step(1);
      farthest = std::max(farthest, run.observe("m.position.x"));
    }
    EXPECT_NEAR(farthest, impact / omega, 2e-3 * farthest);
    // The control: a wall in the mass's place would have sent the ball back at its full speed.
    EXPECT_GT(std::abs(after1 + v), 0.5);
  }
}

// Balls that bounce on each other under gravity conserve their energy: each touch is answered at its own
// time.
TEST(CouplingValidation, ElasticBouncesUnderGravityKeepTheEnergy) {
  SceneRun run(R"({"time": {"dt": 0.01}, "systems": [
      {"type": "mass_spring", "id": "floor", "mesh": {"vertices": [[-5, 0, -5], [5, 0, -5], [0, 0, 5]],
        "triangles": [0, 1, 2]}, "pins": [0, 1, 2]},
      {"type": "particles", "id": "ball", "radius": 0.1, "positions": [[0, 1.1, 0]]}],
    "couplings": [{"type": "contact", "a": "ball", "b": "floor", "restitution": 1, "friction": 0}]})");
  const double before = run.observe("ball.energy.total");
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    run.session.step(1);
    worst = std::max(worst, std::abs(run.observe("ball.energy.total") - before));
  }
  // Some 22 bounces on exact parabolas; the position of a touch is known to a thousandth of the radii, 1e-4
  // m, either way.
  EXPECT_LT(worst, 22 * 1e-4 * 9.81);
}

}  // namespace
}  // namespace truestep
