// Limits, motors and gears of joints between rigid bodies in 3-D against closed forms, with controls that
// fail them.
#include "tests/validation/rigid/rigid3d_joints.h"

#include <gtest/gtest.h>

namespace truestep::testing {
using namespace rigid3d;
namespace {

using std::numbers::pi;

TEST(Rigid3dDrives, AHingesLimitHoldsUnderLoadAndDoesNotBounce) {
  HingeJointDef j = hung<HingeJointDef>();
  j.lower = -0.5;
  RigidRun run(pendulum(j), 1.0 / 60);
  run.seconds(0.25);
  EXPECT_GT(run.observed("joint.j.angle"), -0.5);  // on its way
  run.seconds(0.3);
  // It reaches the limit and stays there: within a milliradian.
  EXPECT_LT(worst(run, 120, [](const RigidRun& r) { return r.observed("joint.j.angle") + 0.5; }), 1e-3);
  EXPECT_LT(norm(run.w(0)), 1e-3);
  // Moment of the weight about the hinge: m g l cos(0.5).
  EXPECT_NEAR(run.observed("joint.j.torque"), 10 * kG * 0.5 * std::cos(0.5), 0.5);
  // The control: without a limit it swings past.
  RigidRun loose(pendulum(hung<HingeJointDef>()), 1.0 / 60);
  loose.seconds(0.65);
  EXPECT_LT(std::asin(loose.x(0).y / 0.5), -0.6);
}

TEST(Rigid3dDrives, TurnsAreCountedBeyondHalfATurn) {
  HingeJointDef j = hung<HingeJointDef>();
  j.upper = 10, j.motor_speed = 20, j.max_motor = 100;
  RigidRun run(pendulum(j), 1.0 / 60, 1, kNoGravity);
  run.seconds(3);
  EXPECT_NEAR(run.observed("joint.j.angle"), 10, 2e-3);  // 1.6 turns
  // The control: there is no limit at 10 - 2 pi.
  j.upper.reset();
  RigidRun free(pendulum(j), 1.0 / 60, 1, kNoGravity);
  free.seconds(3);
  EXPECT_GT(free.observed("joint.j.angle"), 50);
}

TEST(Rigid3dDrives, AMotorReachesItsSpeedWhenItsTorqueSays) {
  // I w = tau t about the hinge, which is at the rod's end.
  HingeJointDef j = hung<HingeJointDef>();
  j.motor_speed = 4, j.max_motor = kRodMoment * 4;
  RigidRun run(pendulum(j), 1.0 / 60, 1, kNoGravity);
  run.seconds(0.5);
  EXPECT_NEAR(run.w(0).z, 2, 0.005 * 2);
  EXPECT_NEAR(run.observed("joint.j.torque"), kRodMoment * 4, 0.01 * kRodMoment * 4);
  run.seconds(0.45);
  EXPECT_LT(run.w(0).z, 3.85);
  run.seconds(0.1);
  EXPECT_NEAR(run.w(0).z, 4, 1e-3);
  // The control: with a tenth less torque it has not arrived yet.
  j.max_motor = 0.9 * kRodMoment * 4;
  RigidRun weak(pendulum(j), 1.0 / 60, 1, kNoGravity);
  weak.seconds(1.05);
  EXPECT_LT(weak.w(0).z, 3.85);
}

TEST(Rigid3dDrives, AServoComesToItsAngleAtItsRateAndHoldsTheWeight) {
  HingeJointDef j = hung<HingeJointDef>();
  j.motor_target = 1, j.max_motor = 2000, j.motor_rate = 3;
  RigidRun run(pendulum(j), 1.0 / 60);
  run.seconds(1);
  EXPECT_NEAR(1 - run.observed("joint.j.angle"), std::exp(-3), 0.05 * std::exp(-3));
  run.seconds(3);
  EXPECT_NEAR(run.observed("joint.j.angle"), 1, 1e-4);
  EXPECT_NEAR(run.observed("joint.j.torque"), 10 * kG * 0.5 * std::cos(1.0), 0.1);
  Command c;
  c.kind = CommandKind::set_parameter, c.name = "motor_target", c.index = 0, c.value = -2;
  run.apply(c);
  run.seconds(4);
  EXPECT_NEAR(run.observed("joint.j.angle"), -2, 1e-4);
  // The control: less than the weight's moment does not hold it.
  c.name = "max_motor", c.value = 5;
  run.apply(c);
  run.seconds(2);
  EXPECT_GT(std::abs(run.observed("joint.j.angle") + 2), 0.1);
}

/// Two wheels on the world, moments 0.5 m r^2 about z.
Rigid3dDef wheels() {
  Rigid3dDef d;
  for (const double x : {0.0, 2.0}) {
    CylinderBodyDef w;
    w.position = {x, 0, 0}, w.axis = {1, 0, 0}, w.angle = pi / 2;
    w.radius = x == 0 ? 0.5 : 1, w.half_length = 0.1, w.mass = 4;
    d.bodies.push_back(w);
    HingeJointDef j;
    j.id = x == 0 ? "first" : "second";
    j.a = -1, j.b = x == 0 ? 0 : 1, j.anchor = Vec3{x, 0, 0}, j.axis = {0, 0, 1};
    d.joints.push_back(j);
  }
  return d;
}

TEST(Rigid3dDrives, AGearKeepsItsRatioAndTransmitsTorque) {
  const double first = 0.5 * 4 * 0.25, second = 0.5 * 4 * 1, ratio = 2, torque = 3;
  Rigid3dDef d = wheels();
  auto& hinge = std::get<HingeJointDef>(d.joints[0]);
  hinge.motor_speed = 1e3, hinge.max_motor = torque;
  GearJointDef gear;
  gear.id = "gear", gear.first = 0, gear.second = 1, gear.ratio = ratio;
  d.joints.push_back(gear);
  RigidRun run(d, 1.0 / 60, 1, kNoGravity);
  run.seconds(5);
  // angle + ratio angle = 0: (I1 + I2 / ratio^2) a = torque, over some 60 rad and ten turns.
  const double a = torque / (first + second / (ratio * ratio));
  EXPECT_NEAR(run.w(0).z, a * 5, 1e-3 * a * 5);
  EXPECT_NEAR(run.w(1).z, -run.w(0).z / ratio, 1e-4 * a * 5);
  EXPECT_NEAR(run.observed("joint.first.angle") + ratio * run.observed("joint.second.angle"), 0, 1e-3);
  EXPECT_GT(run.observed("joint.first.angle"), 20);
  EXPECT_NEAR(run.observed("joint.gear.torque"), second / ratio * a / ratio, 0.01 * torque);
  // The control: without the gear the second stands still.
  d.joints.pop_back();
  RigidRun loose(d, 1.0 / 60, 1, kNoGravity);
  loose.seconds(1);
  EXPECT_EQ(loose.w(1).z, 0);
}

TEST(Rigid3dDrives, ARackMovesByTheTurnOfItsPinion) {
  Rigid3dDef d = wheels();
  d.bodies[1] = bob({0, 1, 0});
  SliderJointDef rack;
  rack.id = "rack", rack.a = -1, rack.b = 1, rack.axis = {1, 0, 0};
  d.joints[1] = rack;
  GearJointDef gear;
  // A pinion of 0.5 m: x = -angle / 2.
  gear.first = 0, gear.second = 1, gear.ratio = 2;
  d.joints.push_back(gear);
  auto& hinge = std::get<HingeJointDef>(d.joints[0]);
  hinge.motor_speed = 1, hinge.max_motor = 100;
  RigidRun run(d, 1.0 / 60, 1, kNoGravity);
  run.seconds(10);
  EXPECT_NEAR(run.observed("joint.rack.position"), -5, 0.01);
  EXPECT_NEAR(run.v(1).x, -0.5, 1e-4);
}

TEST(Rigid3dDrives, SixWaysAreEachLockedFreeSprungOrDriven) {
  // A box of 10 kg on a spring along y: it sags by m g / k; x is driven, turning about y is limited.
  Rigid3dDef d;
  BoxBodyDef b = box({0.2, 0.2, 0.2}, {});
  b.mass = 10, b.angular_velocity = {0, 1, 0};
  d.bodies = {b};
  SixDofJointDef j = hung<SixDofJointDef>();
  j.axis = {1, 0, 0}, j.across = Vec3{0, 1, 0};
  j.y.emplace(), j.y->stiffness = 1000, j.y->damping = 100;
  j.x.emplace(), j.x->motor_speed = 0.5, j.x->upper = 2;
  j.turn_y.emplace(), j.turn_y->upper = 0.6;
  d.joints = {j};
  RigidRun run(d, 1.0 / 60);
  run.seconds(2);
  EXPECT_NEAR(run.x(0).x, 1, 0.01);
  run.seconds(4);
  EXPECT_NEAR(run.observed("joint.j.y"), -10 * kG / 1000, 1e-3);
  EXPECT_NEAR(run.observed("joint.j.x"), 2, 1e-3);
  EXPECT_NEAR(run.x(0).z, 0, 1e-3);
  EXPECT_NEAR(run.observed("joint.j.angle"), 0.6, 2e-3);
  EXPECT_LT(run.observed("joints.tilt"), 1e-3);
  // The control: half the stiffness sags twice as far.
  j.y->stiffness = 500;
  d.joints = {j};
  RigidRun soft(d, 1.0 / 60);
  soft.seconds(6);
  EXPECT_NEAR(soft.x(0).y, -2 * 10 * kG / 1000, 2e-3);
}

TEST(Rigid3dDrives, ThreeTurnsAreCardanAngles) {
  SixDofJointDef j = hung<SixDofJointDef>();
  Rigid3dDef d;
  d.bodies = {bob({})};
  j.axis = {1, 0, 0}, j.across = Vec3{0, 1, 0};
  const double wanted[3] = {0.9, -0.6, 1.4};
  std::optional<TurnDriveDef>* turns[3] = {&j.turn_x, &j.turn_y, &j.turn_z};
  for (int e = 0; e < 3; ++e) turns[e]->emplace(), (*turns[e])->motor_target = wanted[e];
  d.joints = {j};
  RigidRun run(d, 1.0 / 60, 1, kNoGravity);
  run.seconds(4);
  const auto about = [](const Vec3& axis, double angle) {
    return Quat{std::cos(angle / 2), axis.x * std::sin(angle / 2), axis.y * std::sin(angle / 2),
                axis.z * std::sin(angle / 2)};
  };
  const Quat exact = about({1, 0, 0}, wanted[0]) * about({0, 1, 0}, wanted[1]) * about({0, 0, 1}, wanted[2]);
  const Quat q = run.q(0);
  EXPECT_NEAR(std::abs(q.w * exact.w + q.x * exact.x + q.y * exact.y + q.z * exact.z), 1, 1e-7);
}

TEST(Rigid3dDrives, AMotorDrivesAPoseWithBoundedStrength) {
  Rigid3dDef d;
  d.bodies = {bob({0, 1, 0})};
  MotorJointDef j;
  j.a = -1, j.b = 0, j.move = {1, 0, 0}, j.turn = {0, 0, 1}, j.max_force = 30, j.max_torque = 1;
  d.joints = {j};
  RigidRun run(d, 1.0 / 60);
  run.seconds(4);
  EXPECT_NEAR(norm(run.x(0) - Vec3{1, 1, 0}), 0, 1e-4);
  EXPECT_NEAR(2 * std::atan2(run.q(0).z, run.q(0).w), 1, 1e-3);
  Command c;
  c.kind = CommandKind::set_parameter, c.name = "motor_target", c.index = 0, c.vector = {-2, 0, 0};
  run.apply(c);
  run.seconds(4);
  EXPECT_NEAR(run.x(0).x, -2, 1e-3);
  // The control: a force below its weight lets it fall at the missing fraction of g.
  j.max_force = 0.5 * kG, j.move = {};
  d.joints = {j};
  RigidRun weak(d, 1.0 / 60);
  weak.seconds(1);
  EXPECT_NEAR(weak.x(0).y, 1 - 0.5 * 0.5 * kG, 0.03);
}

}  // namespace
}  // namespace truestep::testing
