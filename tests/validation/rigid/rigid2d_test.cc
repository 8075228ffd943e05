// Rigid bodies in the plane against closed forms and reference cases.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/rigid2d_run.h"

namespace truestep {
namespace {

using FlatTrial = testing::FlatTrial;

std::string pendulum(int steps) {
  return R"("precision": "f64", "joint_damping_ratio": 5, "sleeping": false, "substeps": )" +
         std::to_string(steps) +
         R"(, "bodies": [{"position": [1, 0, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.05}]}],
    "joints": [{"type": "distance", "a": -1, "b": 0, "anchor": [0, 0, 0], "anchor_b": [1, 0, 0]}])";
}

TEST(Rigid2dValidation, PendulumFollowsItsClosedForm) {
  // rigid.A01_pendulum; 1e-3 at 10 s is the case's tolerance.
  FlatTrial t(pendulum(40), 1.0 / 240);
  t.steps(240);
  EXPECT_NEAR(t.position(0).x, -0.98629175113187531936, 1e-3);
  EXPECT_NEAR(t.position(0).y, -0.16501085312554116875, 1e-3);
  t.steps(9 * 240);
  EXPECT_NEAR(t.position(0).x, 0.27508746257611686, 1e-3);
  EXPECT_NEAR(t.position(0).y, -0.96141920509912506, 1e-3);
  // The control: a fortieth of the substeps is not enough.
  FlatTrial coarse(pendulum(1), 1.0 / 240);
  coarse.steps(2400);
  EXPECT_GT(std::abs(coarse.position(0).x - 0.27508746257611686), 1e-3);
}

TEST(Rigid2dValidation, DoublePendulumFollowsTheReference) {
  // rigid.double_pendulum_90_90: both arms level, at rest; angles from downward. First order in the substep.
  const auto run = [](int steps) {
    FlatTrial t(
        R"("precision": "f64", "joint_damping_ratio": 5, "sleeping": false, "substeps": )" +
            std::to_string(steps) +
            R"(, "bodies": [{"position": [1, 0, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.05}]},
               {"position": [2, 0, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.05}]}],
      "joints": [{"type": "distance", "a": -1, "b": 0, "anchor": [0, 0, 0], "anchor_b": [1, 0, 0]},
                 {"type": "distance", "a": 0, "b": 1, "anchor": [1, 0, 0], "anchor_b": [2, 0, 0]}])",
        1.0 / 240);
    t.steps(240);
    const Vec3 p = t.position(0), q = t.position(1) - p;
    return std::max(std::abs(std::atan2(p.x, -p.y) + 0.62508769980639063),
                    std::abs(std::atan2(q.x, -q.y) + 1.0345850856800123));
  };
  const double coarse = run(50), fine = run(100);
  EXPECT_LT(fine, 2e-3);
  EXPECT_NEAR(coarse / fine, 2, 0.5);
}

std::string slope(double mu, const char* more = "") {
  return R"("sleeping": false, "substeps": 16, "bodies": [{"motion": "fixed", "angle": )" +
         FlatTrial::number(-std::numbers::pi / 6) + R"(, "friction": )" + FlatTrial::number(mu) +
         R"(, "shapes": [{"type": "box", "half_extents": [50, 1, 0], "center": [0, -1, 0]}]},
    {"position": [0.25, 0.43301270189221935, 0], "angle": )" +
         FlatTrial::number(-std::numbers::pi / 6) + R"(, "friction": )" + FlatTrial::number(mu) +
         R"(, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}])" + more;
}

TEST(Rigid2dValidation, BoxOnASlopeSlidesOrStays) {
  // contact.incline: a = 2.356287236662397 m/s^2 for mu = 0.3; 1.178143618 m in 1 s.
  FlatTrial sliding(slope(0.3), 1.0 / 240);
  const Vec3 from = sliding.position(1);
  sliding.steps(240);
  EXPECT_NEAR(norm(sliding.position(1) - from), 1.178143618331198, 1e-3 * 1.178);
  // Friction 0.6 is above tan 30 degrees: no creep at all after settling (MuJoCo creeps 2e-3 m/s).
  FlatTrial holding(slope(0.6), 1.0 / 240);
  holding.steps(240);
  const Vec3 settled = holding.position(1);
  holding.steps(240);
  EXPECT_LT(norm(holding.position(1) - settled), 1e-5);
}

TEST(Rigid2dValidation, BoxSlidesToAStop) {
  // contact.slide_stop: v0 = 3, mu = 0.4: 1.14679 m in 0.7645 s.
  FlatTrial t(
      R"("sleeping": false, "bodies": [{"motion": "fixed", "friction": 0.4, "shapes": [{"type": "box", "half_extents": [50, 1, 0], "center": [0, -1, 0]}]},
    {"position": [0, 0.25, 0], "velocity": [3, 0, 0], "friction": 0.4, "shapes": [{"type": "box", "half_extents": [1, 0.25, 0]}]}])",
      1.0 / 240);
  t.steps(480);
  EXPECT_NEAR(t.position(1).x, 1.146788990825688, 0.01);
  EXPECT_LT(norm(t.velocity(1)), 1e-6);
}

TEST(Rigid2dValidation, BallBouncesToTheSquareOfRestitution) {
  FlatTrial t(
      R"("sleeping": false, "precision": "f64", "bodies": [{"motion": "fixed", "shapes": [{"type": "box", "half_extents": [50, 1, 0], "center": [0, -1, 0]}]},
    {"position": [0, 1.1, 0], "restitution": 0.8, "shapes": [{"type": "circle", "radius": 0.1}]}])",
      1.0 / 960);
  double top = 0;
  bool fell = false;
  for (int i = 0; i < 960; ++i) {
    t.steps(1);
    fell = fell || t.velocity(1).y > 0;
    if (fell) top = std::max(top, t.position(1).y - 0.1);
  }
  // The impact shows at the end of a step: the motion of one step, 4.4 m/s / 960, is lost.
  EXPECT_NEAR(top, 0.64, 0.01);
}

TEST(Rigid2dValidation, ACradlePassesTheBlowOn) {
  // contact.cradle: five equal discs with gaps of a millionth of a metre.
  const auto last = [](double restitution) {
    std::string bodies;
    for (int k = 0; k < 5; ++k) {
      bodies += (k ? ", " : "") + std::string(R"({"friction": 0, "restitution": )") +
                std::to_string(restitution) + R"(, "velocity": [)" + (k ? "0" : "1") +
                R"(, 0, 0], "position": [)" + FlatTrial::number(0.200001 * k - (k ? 0 : 0.1)) +
                R"(, 0, 0], "shapes": [{"type": "circle", "radius": 0.1}]})";
    }
    FlatTrial t(
        R"("precision": "f64", "gravity": [0, 0, 0], "restitution_speed": 0, "bodies": [)" + bodies + "]",
        1.0 / 240);
    t.steps(48);
    return t.velocity(4).x;
  };
  EXPECT_NEAR(last(1), 1, 1e-6);
  EXPECT_NEAR(last(0.9), 0.81450625, 1e-6 * 0.8145);
  EXPECT_LT(last(0), 0.3);
}

TEST(Rigid2dValidation, MomentumStaysInAClosedSystem) {
  FlatTrial t(R"("gravity": [0, 0, 0], "sleeping": false, "precision": "f64", "generators": [
     {"type": "grid", "nx": 6, "ny": 6, "joined": true, "spacing": [1, 1, 0], "body": {"velocity": [1, 0, 0], "shapes": [{"type": "box", "half_extents": [0.4, 0.4, 0]}]}},
     {"type": "grid", "nx": 4, "ny": 4, "origin": [9, 1, 0], "spacing": [0.7, 0.7, 0], "body": {"velocity": [-3, 0.5, 0], "shapes": [{"type": "circle", "radius": 0.3}]}}])",
              1.0 / 60);
  const double px = t.observed("momentum.x"), py = t.observed("momentum.y"),
               turning = t.observed("angular_momentum.z");
  const double energy = t.observed("energy.kinetic");
  t.steps(300);
  EXPECT_NEAR(t.observed("momentum.x"), px, 1e-9 * 1e5);
  EXPECT_NEAR(t.observed("momentum.y"), py, 1e-9 * 1e5);
  // Impulses act at anchors that are one step old: a part in a thousand.
  EXPECT_NEAR(t.observed("angular_momentum.z"), turning, 0.02 * std::abs(turning) + 500);
  EXPECT_LT(t.observed("energy.kinetic"), energy);
}

TEST(Rigid2dValidation, GearsPulleysAndMotorsKeepTheirRatios) {
  FlatTrial gears(
      R"("bodies": [{"position": [-1, 0, 0], "shapes": [{"type": "circle"}]}, {"position": [1, 0, 0], "shapes": [{"type": "circle"}]}],
    "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [-1, 0, 0], "motor_speed": 4}, {"type": "revolute", "a": -1, "b": 1, "anchor": [1, 0, 0]},
               {"type": "gear", "a": 0, "b": 1, "ratio": 4}])",
      1.0 / 120);
  gears.steps(120);
  EXPECT_NEAR(gears.spin(1), -1, 1e-3);
  EXPECT_NEAR(gears.angle(1), -1, 0.02);

  // Masses m and 2 m on a rope with ratio 1: a = g / 3.
  FlatTrial pulley(
      R"("gravity": [0, -9, 0], "bodies": [{"position": [-1, 0, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.2}]},
      {"position": [1, 0, 0], "mass": 2, "shapes": [{"type": "circle", "radius": 0.2}]}],
    "joints": [{"type": "pulley", "a": 0, "b": 1, "anchor": [-1, 0, 0], "anchor_b": [1, 0, 0], "ground_a": [-1, 5, 0], "ground_b": [1, 5, 0]}])",
      1.0 / 240);
  pulley.steps(240);
  EXPECT_NEAR(pulley.position(0).y, 1.5, 0.03);
  EXPECT_NEAR(pulley.position(0).y + pulley.position(1).y, 0, 5e-3);

  FlatTrial limited(
      R"("bodies": [{"position": [1, 0, 0], "shapes": [{"type": "box", "half_extents": [1, 0.1, 0]}]}],
    "joints": [{"type": "revolute", "a": -1, "b": 0, "anchor": [0, 0, 0], "lower": -0.5, "upper": 0.5}])",
      1.0 / 120);
  limited.steps(600);
  EXPECT_NEAR(limited.angle(0), -0.5, 0.01);

  FlatTrial slider(R"("gravity": [0, 0, 0], "bodies": [{"position": [0, 0, 0], "shapes": [{"type": "box"}]}],
    "joints": [{"type": "prismatic", "a": -1, "b": 0, "axis": [1, 1, 0], "upper": 2, "motor_speed": 1, "max_motor": 100000}])",
                   1.0 / 120);
  slider.steps(120);
  // It takes a hundredth of a second until it moves at full speed.
  EXPECT_NEAR(slider.position(0).x, std::sqrt(0.5), 0.01);
  EXPECT_NEAR(slider.position(0).y, std::sqrt(0.5), 0.01);
  slider.steps(240);
  EXPECT_NEAR(norm(slider.position(0)), 2, 0.02);

  FlatTrial welded(
      R"("bodies": [{"position": [0.5, 0, 0], "shapes": [{"type": "box", "half_extents": [0.5, 0.1, 0]}]}],
    "joints": [{"type": "weld", "a": -1, "b": 0, "anchor": [0, 0, 0]}])",
      1.0 / 120);
  welded.steps(600);
  EXPECT_NEAR(welded.angle(0), 0, 0.01);

  FlatTrial motor(R"("gravity": [0, 0, 0], "bodies": [{"position": [0, 0, 0], "shapes": [{"type": "box"}]}],
    "joints": [{"type": "motor", "a": -1, "b": 0, "move": [2, 1, 0], "turn": 0.5, "max_force": 1e6, "max_torque": 1e6}])",
                  1.0 / 120);
  motor.steps(360);
  EXPECT_NEAR(motor.position(0).x, 2, 0.01);
  EXPECT_NEAR(motor.angle(0), 0.5, 0.01);

  FlatTrial mouse(
      R"("gravity": [0, 0, 0], "bodies": [{"position": [0, 0, 0], "shapes": [{"type": "circle"}]}],
    "joints": [{"type": "mouse", "a": -1, "b": 0, "anchor": [0, 0, 0], "target": [3, -1, 0]}])",
      1.0 / 120);
  mouse.steps(360);
  EXPECT_NEAR(mouse.position(0).x, 3, 0.01);

  FlatTrial spring(
      R"("gravity": [0, 0, 0], "bodies": [{"position": [2, 0, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.1}]}],
    "joints": [{"type": "distance", "a": -1, "b": 0, "anchor": [0, 0, 0], "anchor_b": [2, 0, 0], "length": 1, "hertz": 1, "damping_ratio": 0}])",
      1.0 / 960);
  spring.steps(480);
  // Half a period of 1 Hz: from 1 m beyond to 1 m short of the rest length, which is the pivot.
  EXPECT_NEAR(spring.position(0).x, 0, 0.05);
}

}  // namespace
}  // namespace truestep
