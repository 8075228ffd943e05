// Points that hit the links of a tree or hang on them: momentum, faces that nothing passes. (The laws of a
// hit and springs that carry are in tests/scenes/couplings.)
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

}  // namespace
}  // namespace truestep
