// Points that hit the links of a tree, hang on them or carry them: momentum, faces that nothing passes, the
// laws of a hit.
#include <cmath>

#include "engine/collision/point_distance.h"
#include "engine/geometry/transform.h"
#include "tests/support/jointed_bodies.h"

namespace truestep {
namespace {

using namespace testing_coupled;

TEST(LinkContacts, BallsAndAFreeTreeKeepMomentum) {
  for (const char* law : {R"("restitution": 1, "friction": 0)", R"("restitution": 0.3, "friction": 0.6)"}) {
    SceneRun run(
        scene_of(dust({0.4, 2, 0.3}, {0, -4, 0}, {0.8, 0.8, 0.4}) + "," + kBody,
                 R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", )" + std::string(law) + "}"));
    const auto sums = [&] {
      Momenta m = of_points(run);
      m.linear += run.observe3("doll.momentum"), m.angular += run.observe3("doll.angular_momentum");
      return m;
    };
    const Momenta before = sums();
    const Vec3 own = run.observe3("doll.momentum");
    run.session.step(300);
    const Momenta after = sums();
    // The tree's own motion is integrated to 1e-6 of its steps (the method's tolerance): a coupling adds only
    // rounding to that. The control: the same tree alone drifts as far.
    SceneRun alone(scene_of(kBody, ""));
    alone.session.step(300);
    const double drift = norm(alone.observe3("doll.momentum") - own);
    EXPECT_LT(norm(after.linear - before.linear), 1e-11 * before.scale + 100 * drift) << law << " " << drift;
    EXPECT_LT(norm(after.angular - before.angular), 1e-6 * before.scale) << law;
    EXPECT_GT(run.observe("c.impulse.sum"), 10) << law;
    EXPECT_GT(norm(run.observe3("doll.momentum") - own), 10) << law;
    EXPECT_LT(run.observe("c.penetration"), 1e-6) << law;
  }
}

// No ball is closer to any link than its radius, however fast it arrives.
TEST(LinkContacts, NoBallPassesALink) {
  for (const double speed : {5.0, 200.0}) {
    SceneRun run(scene_of(dust({0.4, 2, 0.3}, {0, -speed, 0}, {0.8, 0.8, 0.4}) + "," + kBody,
                          R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", "restitution": 0})"));
    const BodyPort port = *run.world->system(1).ports().bodies;
    for (int k = 0; k < 150; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
      const ConstBodies b(run.session.state().systems[1], port);
      for (size_t row = 0; row < 3; ++row) {
        const Transform at{rotation(b.orientation(row)), b.place(row)};
        for (size_t i = 0; i < p.count; ++i) {
          const auto d = point_distance(*b.form(row).solid, at.inverse_point(p.place(i)), 0.1);
          if (d) {
            ASSERT_GT(d->distance, 0.02 - 1e-4) << speed << " ball " << i << " link " << row << " step " << k;
          }
        }
      }
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 10);
  }
}

// A ball hits a hinged rod at a = 0.8 m from the hinge: there the rod has the effective mass M = I / a^2, and
// for e = 1 v' = (m - M) / (m + M) v (Landau, Lifshitz, Mechanics, section 17 with one coordinate each).
TEST(LinkContacts, ABallBouncesOffAHingedRod) {
  for (const double e : {1.0, 0.5}) {
    char law[160];
    std::snprintf(
        law, sizeof law,
        R"({"type": "contact", "id": "c", "a": "ball", "b": "rod", "restitution": %g, "friction": 0, "rest_speed": 0})",
        e);
    SceneRun run(R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [
        {"type": "particles", "id": "ball", "mass": 0.7, "radius": 0.05, "positions": [[-0.3, -0.8, 0]], "velocities": [[2, 0, 0]]},
        {"type": "articulation", "id": "rod", "links": [{"parent": "ground", "mass": 3,
          "shapes": [{"type": "box", "half_extents": [0.02, 0.5, 0.02], "position": [0, -0.5, 0]}]}]}],
      "couplings": [)" +
                 std::string(law) +
                 R"(], "probes": [{"id": "ball", "system": "ball", "fields": ["velocity"]}]})");
    const double inertia = 3 * ((0.04 * 0.04 + 1) / 12 + 0.25), M = inertia / 0.64, m = 0.7;
    while (run.observe("c.impulse.sum") == 0 && run.session.step_index() < 1000) run.session.step(1);
    EXPECT_NEAR(run.observe("ball.velocity.x"), (m - e * M) / (m + M) * 2, 1e-12) << e;
    EXPECT_NEAR(run.observe("rod.angular_momentum.z"), 0.8 * m * (1 + e) * M / (m + M) * 2, 1e-9) << e;
    EXPECT_NEAR(run.observe("c.energy.lost"), 0.5 * m * M / (m + M) * 4 * (1 - e * e), 1e-12) << e;
  }
}

// A rope that hangs on a hand: the two places coincide to rounding, and momentum is as without the hook.
TEST(LinkContacts, ARopeHooksOn) {
  SceneRun run(scene_of(
      R"({"type": "mass_spring", "id": "rope", "rope": {"from": [2, 0.3, 0.3], "to": [3, 0.3, 0.3], "links": 6},
      "mass": 0.05, "stiffness": 2000, "velocity": [0, 1, 0], "integrator": "velocity_verlet"},)" +
          std::string(kBody),
      R"({"type": "attachment", "id": "hook", "a": "rope", "b": "doll", "link": "rigid", "a_points": [0], "b_points": [2], "places": [[2, 0.3, 0.3]]})",
      0.002));
  run.session.step(1);
  const auto sums = [&] {
    Momenta m = of_points(run);
    m.linear += run.observe3("doll.momentum"), m.angular += run.observe3("doll.angular_momentum");
    return m;
  };
  const Momenta before = sums();
  double worst = 0;
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    worst = std::max(worst, run.observe("hook.length.error"));
  }
  const Momenta after = sums();
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(norm(after.linear - before.linear), 1e-9);
  EXPECT_LT(norm(after.angular - before.angular), 1e-6);
  EXPECT_GT(run.observe("hook.impulse.sum"), 0.1);
}

// A hand on a spring to a pinned point: m g = k stretch at rest.
TEST(LinkContacts, ASpringCarriesALink) {
  SceneRun run(scene_of(
      R"({"type": "mass_spring", "id": "pin", "free": {"points": [[0, 2, 0]]}, "pins": [0]},
      {"type": "articulation", "id": "slide", "links": [{"parent": "ground", "joint": "prismatic", "axis": [0, 1, 0], "q": [1],
        "mass": 2, "inertia": [0.1, 0.1, 0.1]}]})",
      R"({"type": "attachment", "id": "s", "a": "slide", "b": "pin", "stiffness": 200, "damping": 10})",
      0.004, "[0, -9.81, 0]"));
  run.session.step(2500);
  Observables out;
  const ConstBodies b(run.session.state().systems[1], *run.world->system(1).ports().bodies);
  EXPECT_NEAR(b.place(0).y, 1 - 2 * 9.81 / 200, 1e-5);
}

}  // namespace
}  // namespace truestep
