// Bodies that spin on a face: the ground's friction brakes the spin and, as long as that lasts, gives hardly
// any sideways resistance. With full friction at a centre of pressure slightly off the axis, cylinders at 45
// to 100 rad/s went round in circles and away.
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

std::string spinning(const std::string& body, const std::string& precision, double friction) {
  return R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.016666666666666666}, "systems": [
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
    SceneRun run(spinning(disc(kSpin), precision, kFriction));
    run.session.step(60);
    // The closed form neglects terms of the order of (v / (w R))^2 = 1e-4, and the shift of the centre of
    // pressure by friction at the ground, mu v / (w R) times the half height, 1e-3 of R. Of the 0.02 m/s that
    // it loses, a single step with full friction would take 0.03.
    EXPECT_NEAR(run.observe("top.velocity.x"), left, 2e-3 * kSpeed) << precision;
    // The control: without spin, full friction brakes it.
    SceneRun still(spinning(disc(0), precision, kFriction));
    still.session.step(60);
    EXPECT_NEAR(still.observe("top.velocity.x"), 0, 1e-4) << precision;
  }
}

}  // namespace
}  // namespace truestep
