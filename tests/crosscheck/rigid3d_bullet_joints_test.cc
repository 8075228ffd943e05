// Joints of rigid3d compared with those of Bullet 3.24 (double): the same positions at the same times, to the
// error of Bullet's first-order steps.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/runs/engine_run.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

constexpr double kG = 9.81;

template <class J>
J joint(int64_t a, int64_t b, Vec3 anchor, Vec3 axis = {0, 1, 0}) {
  J j;
  j.a = a, j.b = b, j.anchor = anchor;
  if constexpr (requires { j.axis; }) j.axis = axis;
  return j;
}

double apart(const EngineRun& a, const EngineRun& b) {
  double most = 0;
  for (size_t i = 0; i < a.count(); ++i) most = std::max(most, norm(a.x(i) - b.x(i)));
  return most;
}

/// Largest distance of the two engines over two seconds of a pendulum.
double pendulum(const Rigid3dDef& d, double h, const Rigid3dDef& peer) {
  EngineRun a = ours(d, h), b = theirs(peer, h);
  double most = 0;
  for (int k = 0; k < 20; ++k) {
    a.seconds(0.1), b.seconds(0.1);
    most = std::max(most, apart(a, b));
  }
  return most;
}

template <class J>
Rigid3dDef hanging() {
  constexpr bool turns = std::is_same_v<J, BallJointDef>;
  Rigid3dDef d;
  BoxBodyDef b = box({0.5, 0.1, 0.1}, {0.5, 0, 0});
  b.angular_velocity = turns ? Vec3{0, 1, 0} : Vec3{};
  b.velocity = turns ? Vec3{0, 0, -0.5} : Vec3{};
  d.bodies = {b};
  d.joints = {joint<J>(-1, 0, {0, 0, 0}, {0, 0, 1})};
  d.sleeping = false, d.substeps = 16, d.precision = Rigid3dDef::Precision::f64;
  return d;
}

TEST(Bullet, PendulumsOnBallAndHingeConvergeToTheSamePath) {
  for (const Rigid3dDef& d : {hanging<BallJointDef>(), hanging<HingeJointDef>()}) {
    const double coarse = pendulum(d, 1.0 / 240, d), fine = pendulum(d, 1.0 / 960, d);
    EXPECT_LT(fine, 0.02) << d.joints[0].index();
    // First order: a quarter of the step gives a quarter of the difference, with room for our own error.
    EXPECT_GT(coarse, 2.5 * fine) << d.joints[0].index();
    // Control: another pendulum, with 2 % less gravity, does not follow that path.
    Rigid3dDef other = d;
    other.gravity = Vec3{0, -0.98 * kG, 0};
    EXPECT_GT(pendulum(d, 1.0 / 960, other), 0.03) << d.joints[0].index();
  }
}

TEST(Bullet, ASliderFallsAlongItsAxisOnly) {
  Rigid3dDef d;
  d.bodies = {box({0.5, 0.1, 0.2}, {0.3, 0, 0})};
  d.joints = {joint<SliderJointDef>(-1, 0, {0, 0, 0}, {1, 1, 0})};
  d.sleeping = false;
  EngineRun a = ours(d, 1.0 / 240), b = theirs(d, 1.0 / 240);
  a.seconds(1), b.seconds(1);
  const double down = 0.5 * kG * 0.5;  // g sin(45 deg) along the axis, of which sin(45 deg) is vertical
  for (const EngineRun* r : {&a, &b}) {
    EXPECT_NEAR(r->x(0).y, -down, 0.02);
    EXPECT_NEAR(r->x(0).x - 0.3, -down, 0.02);
  }
}

TEST(Bullet, FixedBodiesMoveAsOne) {
  Rigid3dDef d;
  d.bodies = {box({0.5, 0.1, 0.2}, {0, 0, 0}), box({0.5, 0.1, 0.2}, {1, 0, 0})};
  std::get<BoxBodyDef>(d.bodies[0]).angular_velocity = {0, 0, 2};
  std::get<BoxBodyDef>(d.bodies[1]).angular_velocity = {0, 0, 2};
  std::get<BoxBodyDef>(d.bodies[1]).velocity = {0, 2, 0};
  d.joints = {joint<FixedJointDef>(0, 1, {0.5, 0, 0})};
  d.gravity = Vec3{}, d.sleeping = false;
  EngineRun a = ours(d, 1.0 / 480), b = theirs(d, 1.0 / 480);
  a.seconds(1), b.seconds(1);
  EXPECT_LT(apart(a, b), 0.02);
  EXPECT_NEAR(norm(b.x(1) - b.x(0)), 1, 0.005);
}

/// A weight off the joint's anchor, on a joint to the world.
Rigid3dDef on(AnyJointDef joint, Vec3 at = {0.6, 0, 0}) {
  Rigid3dDef d;
  d.bodies = {box({0.5, 0.1, 0.2}, at)};
  std::visit(
      [](auto& j) {
        if constexpr (std::is_base_of_v<JointDef, std::decay_t<decltype(j)>>) {
          j.a = -1, j.b = 0, j.anchor = Vec3{};
        }
      },
      joint);
  d.joints = {joint};
  d.sleeping = false, d.substeps = 8;
  return d;
}

/// Largest distance of both engines over `seconds`.
double parting(const Rigid3dDef& d, double seconds, double h = 1.0 / 960) {
  EngineRun a = ours(d, h), b = theirs(d, h);
  double most = 0;
  for (int k = 0; k < 10; ++k) {
    a.seconds(seconds / 10), b.seconds(seconds / 10);
    most = std::max(most, apart(a, b));
  }
  EXPECT_LT(norm(a.x(0)), 2);
  return most;
}

TEST(Bullet, LimitsMotorsAndSpringsOfJointsDoTheSame) {
  HingeJointDef hinge;
  hinge.axis = {0, 0, 1};
  const double free = parting(on(hinge), 1);
  EXPECT_LT(free, 0.02);
  HingeJointDef stopped = hinge;
  stopped.lower = -0.5;
  EXPECT_LT(parting(on(stopped), 1), 0.02);
  HingeJointDef driven = hinge;
  driven.motor_speed = 1.5, driven.max_motor = 1e5;
  EXPECT_LT(parting(on(driven), 2), 0.02);
  HingeJointDef sprung = hinge;
  sprung.stiffness = 1500, sprung.damping = 20;
  EXPECT_LT(parting(on(sprung), 1), 0.02);
  SliderJointDef slider;
  slider.axis = {0, 1, 0}, slider.stiffness = 5000, slider.damping = 50;
  EXPECT_LT(parting(on(slider), 1), 0.02);
  slider.stiffness.reset(), slider.damping.reset(), slider.lower = -0.3;
  EXPECT_LT(parting(on(slider), 1), 0.02);
  // Control: another limit is another path.
  HingeJointDef other = stopped;
  other.lower = -0.6;
  EngineRun a = ours(on(stopped)), b = theirs(on(other));
  a.seconds(1), b.seconds(1);
  EXPECT_GT(apart(a, b), 0.04);
}

TEST(Bullet, UniversalConeTwistAndSixWaysDoTheSame) {
  UniversalJointDef cross;
  cross.axis = {0, 1, 0}, cross.axis_b = {0, 0, 1};
  EXPECT_LT(parting(on(cross), 0.6), 0.02);
  ConeTwistJointDef cone;
  cone.axis = {1, 0, 0};
  EXPECT_LT(parting(on(cone), 0.6), 0.02);
  SixDofJointDef six;
  six.across = Vec3{0, 1, 0};
  six.y.emplace().stiffness = 4000.0, six.y->damping = 100.0;
  six.turn_z.emplace();
  EXPECT_LT(parting(on(six), 0.6), 0.02);
  cone.swing = 0.4;
  // The stop of a cone is soft in both engines: where it stops is compared, not how it gets there.
  EngineRun a = ours(on(cone), 1.0 / 960), b = theirs(on(cone), 1.0 / 960);
  a.seconds(4), b.seconds(4);
  EXPECT_NEAR(a.x(0).y, -0.6 * std::sin(0.4), 0.03);
  EXPECT_NEAR(b.x(0).y, -0.6 * std::sin(0.4), 0.03);
}

TEST(Bullet, RefusesJointsByTheMemberThatItLacks) {
  const auto pointer = [](AnyJointDef joint) -> std::string {
    try {
      theirs(on(std::move(joint)));
    } catch (const Error& e) {
      return e.issues().at(0).pointer;
    }
    return "";
  };
  HingeJointDef hinge;
  hinge.hertz = 3;
  EXPECT_EQ(pointer(hinge), "/joints/0/hertz");
  SixDofJointDef six;
  six.turn_x.emplace().motor_target = 1;
  EXPECT_EQ(pointer(six), "/joints/0/turn_x/motor_target");
  EXPECT_EQ(pointer(DistanceJointDef{}), "/joints/0/type");
  EXPECT_EQ(pointer(BallJointDef{}), "");
}

TEST(Bullet, JointsBreakAndDampingFades) {
  Rigid3dDef d;
  SphereBodyDef weight = ball(0.1, {0, 0, 0}), slow = ball(0.1, {5, 0, 0});
  weight.mass = 1, slow.gravity_scale = 0, slow.velocity = {1, 0, 0}, slow.linear_damping = 2;
  d.bodies = {weight, slow};
  BallJointDef weak = joint<BallJointDef>(-1, 0, {0, 0, 0});
  weak.break_force = 5;  // of the 9.81 N that it carries
  d.joints = {weak};
  EngineRun b = theirs(d);
  b.seconds(1);
  EXPECT_EQ(b.observed("joints.broken"), 1);
  EXPECT_LT(b.x(0).y, -3);
  EXPECT_NEAR(b.v(1).x, std::exp(-2), 1e-9);
  weak.break_force = 20;
  d.joints = {weak};
  EngineRun strong = theirs(d);
  strong.seconds(1);
  EXPECT_EQ(strong.observed("joints.broken"), 0);
}

}  // namespace
}  // namespace truestep::testing
