// Every kind of joint in motion: the same bits for any number of threads, after a restore halfway, and
// without scratch memory.
#include <gtest/gtest.h>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::RigidRun;

/// Pairs of boxes above the ground, each held by another kind of joint, the first of each pair by the world.
Rigid3dDef machines() {
  Rigid3dDef d;
  d.bodies.push_back(testing::ground());
  int64_t row = 0;
  double x = -6, y = 0.6;
  const auto pair = [&](auto joint, auto first) {
    for (int k = 0; k < 2; ++k) {
      BoxBodyDef b = testing::box({0.2, 0.1, 0.15}, {x + 0.5 * k, y + 0.2 * k, 0.1 * k});
      b.angular_velocity = {1, -0.5, 0.7};
      d.bodies.push_back(b), ++row;
      if (k == 0) first.a = -1, first.b = row, d.joints.push_back(first);
    }
    joint.id = "j" + std::to_string(row), joint.a = row - 1, joint.b = row;
    d.joints.push_back(joint);
    x += 1.1;
  };
  const BallJointDef ball;
  HingeJointDef hinge;
  hinge.axis = {0, 0, 1}, hinge.lower = -1, hinge.upper = 9, hinge.motor_speed = 6, hinge.max_motor = 20;
  SliderJointDef slider;
  slider.axis = {1, 0.2, 0}, slider.lower = -0.2, slider.upper = 0.3, slider.hertz = 2;
  CylindricalJointDef cylindrical;
  cylindrical.slide.emplace(), cylindrical.slide->stiffness = 500, cylindrical.slide->damping = 5;
  cylindrical.turn.emplace(), cylindrical.turn->motor_target = 1, cylindrical.turn->max_motor = 50;
  DistanceJointDef rope;
  rope.maximum = 0.6, rope.break_force = 4000;
  SpringJointDef spring;
  spring.stiffness = 800, spring.damping = 3;
  ConeTwistJointDef cone;
  cone.swing = 0.4, cone.twist_lower = -0.5, cone.twist_upper = 0.5;
  SixDofJointDef six;
  six.x.emplace(), six.turn_y.emplace(), six.turn_z.emplace();
  six.x->upper = 0.1, six.turn_y->stiffness = 20, six.turn_z->upper = 0.5;
  MotorJointDef motor;
  motor.move = {0.1, 0.2, 0}, motor.turn = {0, 1, 0}, motor.max_force = 900, motor.max_torque = 40;
  pair(ball, ball), pair(FixedJointDef{}, ball), pair(hinge, ball), pair(slider, ball),
      pair(cylindrical, ball);
  pair(PlaneJointDef{}, ball), pair(rope, ball), pair(spring, ball), pair(UniversalJointDef{}, ball);
  pair(cone, ball), pair(six, ball), pair(motor, ball);
  hinge.lower.reset(), hinge.upper.reset(), hinge.max_motor = 2000, y = 2;  // room to turn
  pair(hinge, HingeJointDef{});
  GearJointDef gear;
  gear.first = static_cast<int64_t>(d.joints.size()) - 1, gear.second = gear.first - 1, gear.ratio = -1.5;
  d.joints.push_back(gear);
  return d;
}

class Rigid3dJointDeterminism : public ::testing::TestWithParam<Rigid3dDef::Precision> {
 protected:
  static Rigid3dDef scene() {
    Rigid3dDef d = machines();
    d.precision = GetParam();
    return d;
  }
};

INSTANTIATE_TEST_SUITE_P(Precisions, Rigid3dJointDeterminism,
                         ::testing::Values(Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64));

TEST_P(Rigid3dJointDeterminism, ThreadsChangeNothing) {
  RigidRun one(scene()), none(scene(), 1.0 / 60, 0), eight(scene(), 1.0 / 60, 8);
  for (RigidRun* run : {&one, &none, &eight}) run->run(120);
  EXPECT_EQ(one.state, none.state);
  EXPECT_EQ(one.state, eight.state);
  // It moves: a motor has turned its hinge by more than half a turn, so that the angles must be in the state.
  EXPECT_GT(one.observed("joint.j26.angle"), 3.2);
}

TEST_P(Rigid3dJointDeterminism, RestoredInMotionItGoesOnTheSame) {
  RigidRun run(scene());
  run.run(70);
  RigidRun other(scene());
  other.state = State::deserialize(run.state.serialize());
  other.steps = run.steps;
  run.run(60), other.run(60);
  EXPECT_EQ(run.state, other.state);
  // The controls: without the drives' impulses, or without the angles, the bits differ.
  for (const auto column : {rigid3d::columns::drive_impulse, rigid3d::columns::drive_coordinate}) {
    RigidRun cold(scene());
    cold.run(70);
    for (double& l : cold.state.f64(column)) l = 0;
    cold.run(60);
    EXPECT_FALSE(run.state == cold.state);
  }
}

TEST_P(Rigid3dJointDeterminism, DroppedWorkspaceChangesNothing) {
  RigidRun kept(scene()), dropped(scene());
  for (int k = 0; k < 60; ++k) {
    kept.run(1), dropped.run(1);
    dropped.workspace.clear();
    ASSERT_EQ(kept.state, dropped.state) << "step " << k;
  }
}

}  // namespace
}  // namespace truestep
