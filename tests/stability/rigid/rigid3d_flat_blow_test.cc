// Boxes that meet face to face without bouncing: their four points share the impulse. Solved one after the
// other, the first point would take it whole; the box would leave rotating, sliding, and at 4 % of its
// approach speed.
#include <algorithm>
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

std::string boxes(const std::string& precision, double speed, double mass, double gap) {
  char scene[1024];
  std::snprintf(scene, sizeof scene, R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [
      {"type": "rigid3d", "id": "a", "sleeping": false, "precision": "%s", "bodies": [
        {"type": "box", "half_extents": [0.5, 0.5, 0.5], "velocity": [%g, 0, 0], "mass": 1, "restitution": 0},
        {"type": "box", "half_extents": [0.5, 0.5, 0.5], "position": [%.17g, 0, 0], "mass": %g,
         "restitution": 0}]}],
    "probes": [{"id": "left", "system": "a", "index": 0, "fields": ["velocity", "angular_velocity"]}]})",
                precision.c_str(), speed, 1 + gap, mass);
  return scene;
}

// Newton's law of impact with e = 0: both continue with the common velocity, wherever in a step they meet.
// Soft contacts leave a hundredth of the approach speed.
TEST(Rigid3dFlatBlow, FacesThatMeetDoNotPart) {
  for (const char* precision : {"f32", "f64"}) {
    for (const double speed : {1.0, 4.0, 11.0}) {
      for (const double mass : {1.0, 1000.0, 1e6}) {
        for (const double share : {0.1, 0.37, 0.5, 0.8}) {
          SceneRun run(boxes(precision, speed, mass, (4 + share) * 0.01 * speed));
          run.session.step(40);
          const std::string what = std::string(precision) + ", " + std::to_string(speed) + " m/s, " +
                                   std::to_string(mass) + " kg, " + std::to_string(share);
          EXPECT_NEAR(run.observe("left.velocity.x"), speed / (1 + mass), 1e-5 * speed) << what;
          EXPECT_LT(norm(run.observe3("left.angular_velocity")), 1e-5 * speed) << what;
          EXPECT_LT(std::abs(run.observe("left.velocity.y")), 1e-5 * speed) << what;
        }
      }
    }
  }
}

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

// A box that falls flat on the ground stays where it fell.
TEST(Rigid3dFlatBlow, WhatFallsFlatStaysWhereItFell) {
  SceneRun run(R"({"time": {"dt": 0.016666666666666666}, "systems": [
      {"type": "rigid3d", "id": "a", "sleeping": false, "bodies": [
        {"type": "plane", "motion": "fixed", "restitution": 0},
        {"type": "box", "half_extents": [0.5, 0.3, 0.4], "position": [0, 2, 0], "restitution": 0}]}],
    "probes": [{"id": "box", "system": "a", "index": 1, "fields": ["position"]}]})");
  run.session.step(180);
  EXPECT_NEAR(run.observe("box.position.x"), 0, 1e-3);
  EXPECT_NEAR(run.observe("box.position.z"), 0, 1e-3);
  EXPECT_NEAR(run.observe("box.position.y"), 0.3, 1e-3);
}

}  // namespace
}  // namespace truestep
