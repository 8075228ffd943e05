// A pendulum released at 150 degrees conserves its energy. Velocities must satisfy its joint at its position
// at the end of a substep: with the directions of the start it would lose (h w)^2 of its energy in every
// substep, 5 J of 9 in 30 s.
#include <gtest/gtest.h>

#include "tests/support/rigid2d_run.h"
#include "tests/support/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

constexpr double kFrom = 150 * 3.14159265358979 / 180;
/// J between the initial position of the rod of 1 kg and 1 m and hanging at rest.
constexpr double kSwing = 9.81 * 0.5 * 1.8660254;

template <class J>
double lost_in_space(Rigid3dDef::Precision precision, double dt, double seconds) {
  Rigid3dDef d;
  d.precision = precision, d.sleeping = false;
  BoxBodyDef rod = box({0.05, 0.5, 0.05}, {0.5 * std::sin(kFrom), -0.5 * std::cos(kFrom), 0});
  rod.mass = 1, rod.axis = {0, 0, 1}, rod.angle = kFrom;
  d.bodies.push_back(rod);
  J j;
  j.a = -1, j.b = 0, j.anchor = Vec3{};
  if constexpr (requires { j.axis; }) j.axis = {0, 0, 1};
  d.joints.push_back(j);
  RigidRun run(d, dt);
  const double before = run.observed("energy.total");
  run.seconds(seconds);
  return before - run.observed("energy.total");
}

double lost_in_plane(const char* precision, const char* joint, double dt, double seconds) {
  FlatTrial t(std::string(R"("sleeping": false, "gravity": [0, -9.81, 0], "precision": ")") + precision +
                  R"(", "bodies": [{"mass": 1, "position": [)" + FlatTrial::number(0.5 * std::sin(kFrom)) +
                  ", " + FlatTrial::number(-0.5 * std::cos(kFrom)) + R"(, 0], "angle": )" +
                  FlatTrial::number(kFrom) +
                  R"(, "shapes": [{"type": "box", "half_extents": [0.05, 0.5, 0]}]}],
    "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0])" +
                  joint + "}]",
              dt);
  const double before = t.observed("energy.total");
  t.steps(static_cast<int>(seconds / dt + 0.5));
  return before - t.observed("energy.total");
}

TEST(RigidPendulum, KeepsItsEnergyInSpaceAndInThePlane) {
  for (const double dt : {1.0 / 60, 1.0 / 240}) {
    // What remains is the oscillation of symplectic Euler's energy by the fraction w h / 2, not a loss.
    const double most = (dt > 0.01 ? 0.02 : 0.005) * kSwing;
    for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
      EXPECT_NEAR(lost_in_space<HingeJointDef>(precision, dt, 30), 0, most) << dt;
      EXPECT_NEAR(lost_in_space<BallJointDef>(precision, dt, 30), 0, most) << dt;
    }
    for (const char* precision : {"f32", "f64"}) {
      EXPECT_NEAR(lost_in_plane(precision, "", dt, 30), 0, most) << dt;
      // A joint with a limit, even one never reached, is solved alone, not in lanes together with others.
      EXPECT_NEAR(lost_in_plane(precision, R"(, "lower": -100)", dt, 30), 0, most) << dt;
    }
  }
}

TEST(RigidPendulum, KeepsItForTwoMinutes) {
  EXPECT_NEAR(lost_in_space<HingeJointDef>(Rigid3dDef::Precision::f32, 1.0 / 60, 120), 0, 0.02 * kSwing);
  EXPECT_NEAR(lost_in_space<BallJointDef>(Rigid3dDef::Precision::f32, 1.0 / 60, 120), 0, 0.02 * kSwing);
  EXPECT_NEAR(lost_in_plane("f32", "", 1.0 / 60, 120), 0, 0.02 * kSwing);
}

}  // namespace
}  // namespace truestep::testing
