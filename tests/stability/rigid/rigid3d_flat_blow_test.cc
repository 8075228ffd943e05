// Boxes that meet face to face without bouncing: their four points share the impulse. Solved one after the
// other, the first point would take it whole; the box would leave rotating, sliding, and at 4 % of its
// approach speed.
#include <algorithm>
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// Seeds 730199 and 121750 of the campaign: the gap is a whole number of steps long, so that the substep
// before the blow leaves the rounding of the gap as a load, of one point more than of another.
TEST(Rigid3dFlatBlow, FacesThatMeetAtTheEndOfAStepShareTheBlow) {
  struct Meeting {
    double dt, half_left, half_right, mass, speed;
  };
  for (const Meeting& m : {Meeting{1.0 / 64, 0.5, 0.25, 1e6, 4}, Meeting{1.0 / 60, 0.25, 1, 1, 10}}) {
    char scene[1024];
    std::snprintf(scene, sizeof scene, R"({"gravity": [0, 0, 0], "time": {"dt": %.17g}, "systems": [
      {"type": "rigid3d", "id": "a", "sleeping": false, "bodies": [
        {"type": "box", "half_extents": [%g, %g, %g], "velocity": [%g, 0, 0], "mass": %g, "restitution": 0},
        {"type": "box", "half_extents": [%g, %g, %g], "position": [%g, 0, 0], "mass": 1, "restitution": 0}]}],
    "probes": [{"id": "left", "system": "a", "index": 0, "fields": ["velocity", "angular_velocity"]},
               {"id": "right", "system": "a", "index": 1, "fields": ["velocity", "angular_velocity"]}]})",
                  m.dt, m.half_left, m.half_left, m.half_left, m.speed, m.mass, m.half_right, m.half_right,
                  m.half_right, 2 + m.half_left + m.half_right);
    SceneRun run(scene);
    run.session.step(60);
    const double common = m.speed * m.mass / (m.mass + 1);
    for (const std::string body : {"left", "right"}) {
      EXPECT_NEAR(run.observe(body + ".velocity.x"), common, 1e-4 * m.speed) << body;
      EXPECT_LT(norm(run.observe3(body + ".angular_velocity")), 1e-4 * m.speed) << body;
    }
  }
}

}  // namespace
}  // namespace truestep
