// Bodies that spin on a face: the ground's friction brakes the spin and, as long as that lasts, gives hardly
// any sideways resistance. With full friction at a centre of pressure slightly off the axis, cylinders at 45
// to 100 rad/s went round in circles and away.
#include <algorithm>
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

constexpr double kFrame = 1.0 / 60;

std::string spinning(const std::string& body, const std::string& precision, double friction,
                     double dt = kFrame) {
  return R"({"gravity": [0, -9.81, 0], "time": {"dt": )" + std::to_string(dt) + R"(}, "systems": [
      {"type": "rigid3d", "id": "a", "precision": ")" +
         precision + R"(", "friction": )" + std::to_string(friction) + R"(, "bodies": [
        {"type": "plane", "motion": "fixed"}, )" +
         body +
         R"(]}], "probes": [{"id": "top", "system": "a", "index": 1, "fields": ["position", "velocity"]}]})";
}

TEST(Rigid3dSpinning, ACylinderStaysWhereItSpins) {
  constexpr double kRadius = 0.81;
  const std::string body = R"({"type": "cylinder", "angular_velocity": [0, 99.9, 0], "position": [0, 0.64, 0],
      "radius": 0.81, "half_length": 0.64})";
  for (const char* precision : {"f32", "f64"}) {
    SceneRun run(spinning(body, precision, 0.8));
    run.session.step(120);
    const Vec3 x = run.observe3("top.position");
    EXPECT_LT(std::hypot(x.x, x.z), 0.02 * kRadius) << precision;
  }
}

// A disc that slides at v while it spins at w, v << w R, is braked by mu N v / (w R) under even pressure
// (Farkas, Bartels, Unger, Wolf 2003, Phys. Rev. Lett. 90, 248302), the law of spinning contacts here: v' =
// -mu g v / (w R). (Four points on the rim alone would give half of that: they rub by v / (w R) perpendicular
// to their motion, and not at all along it.) The spin is braked by the points on the rim, w' = -2 mu g / R;
// even pressure would give two thirds of that, and leave 0.0001 m/s more after a second. The first step used
// to brake as if nothing spun: 0.45 m/s was left.
TEST(Rigid3dSpinning, SlidesOn) {
  constexpr double kFriction = 0.2, kSpeed = 0.5, kRadius = 0.5, kSpin = 100;
  const auto disc = [](double spin) {
    return R"({"type": "cylinder", "angular_velocity": [0, )" + std::to_string(spin) +
           R"(, 0], "velocity": [0.5, 0, 0], "position": [0, 0.1, 0], "radius": 0.5, "half_length": 0.1})";
  };
  const double loss = 2 * kFriction * 9.81 / kRadius;  // rad/s^2
  // v'/v = -(mu g / R) / (w - loss t).
  const double left = kSpeed * std::pow(1 - loss / kSpin, kFriction * 9.81 / kRadius / loss);
  for (const char* precision : {"f32", "f64"}) {
    // In steps in which it turns far, and in steps of a twentieth of a radian.
    for (const int steps : {60, 2000}) {
      SceneRun run(spinning(disc(kSpin), precision, kFriction, 1.0 / steps));
      run.session.step(steps);
      // The closed form neglects terms of the order of (v / (w R))^2 = 1e-4, and the shift of the centre of
      // pressure by friction at the ground, mu v / (w R) times the half height, 1e-3 of R. Of the 0.02 m/s
      // that it loses, a single step with full friction would take 0.03.
      EXPECT_NEAR(run.observe("top.velocity.x"), left, 2e-3 * kSpeed)
          << precision << ", " << steps << " steps";
    }
    // The control: without spin, full friction brakes it.
    SceneRun still(spinning(disc(0), precision, kFriction));
    still.session.step(60);
    EXPECT_NEAR(still.observe("top.velocity.x"), 0, 1e-4) << precision;
  }
}

// As tall as wide, on a face, by 0.054 rad a step: friction of the spin slips, and full friction at a centre
// of pressure off the axis on top of it tipped the cylinder and threw it up by half its height (spin_3d of
// the campaign).
TEST(Rigid3dSpinning, ATallCylinderStaysOnItsFaceInSubsteps) {
  constexpr double kRadius = 0.427, kHalf = 0.405;
  const std::string body = R"({"type": "cylinder", "angular_velocity": [0, 54, 0], "position": [0, 0.405, 0],
      "radius": 0.427, "half_length": 0.405})";
  for (const char* precision : {"f32", "f64"}) {
    SceneRun run(spinning(body, precision, 0.9, 1e-3));
    double highest = 0;
    for (int k = 0; k < 2000; ++k) {
      run.session.step(1), highest = std::max(highest, run.observe3("top.position").y);
    }
    EXPECT_LT(highest, kHalf * 1.001) << precision;
    const Vec3 x = run.observe3("top.position");
    EXPECT_LT(std::hypot(x.x, x.z), 0.02 * kRadius) << precision;
  }
}

// A plate so thin that its corners move farther in a part of a step than it is thick: its upper corners are
// within the margin of contacts, and it stood on two of them, 7 mm deep.
TEST(Rigid3dSpinning, APlateStandsOnItsLowerCorners) {
  constexpr double kHalf = 0.02, kSpin = 30;
  const std::string body = R"({"type": "box", "angular_velocity": [0, 30, 0], "position": [0, 0.02, 0],
      "half_extents": [0.5, 0.02, 0.5]})";
  for (const char* precision : {"f32", "f64"}) {
    SceneRun run(spinning(body, precision, 0.1));
    double lowest = kHalf;
    for (int k = 0; k < 120; ++k) {
      run.session.step(1), lowest = std::min(lowest, run.observe3("top.position").y);
    }
    // Contacts are springs that yield by g / w^2 = 0.2 mm in the 17 ms of a step without its loads.
    EXPECT_GT(lowest, kHalf - 3e-4) << precision;
    const Vec3 x = run.observe3("top.position");
    EXPECT_LT(std::hypot(x.x, x.z), 5e-4) << precision;
  }
  // The control: the upper corners are within a step's motion in five parts.
  EXPECT_GT(kSpin * kFrame / 5 * std::hypot(0.5, 0.5), 2 * kHalf);
}

}  // namespace
}  // namespace truestep
