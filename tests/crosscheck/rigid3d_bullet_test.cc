// rigid3d compared with Bullet 3.24 (double): the same positions at the same times for smooth motion, to the
// error of Bullet's first-order steps; the same statistics for chaotic motion.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/rigid3d_state.h"
#include "tests/support/engine_run.h"
#include "tests/support/rigid3d_run.h"

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

TEST(Bullet, FreeFallDiffersByTheFirstOrderErrorOfItsSteps) {
  // Semi-implicit Euler falls g t h / 2 farther than the parabola; ours follows the parabola.
  Rigid3dDef d;
  d.bodies = {ball(0.5, {0, 10, 0})};
  for (const double h : {1.0 / 60, 1.0 / 120}) {
    EngineRun a = ours(d, h), b = theirs(d, h);
    a.seconds(1), b.seconds(1);
    EXPECT_NEAR(a.x(0).y - b.x(0).y, kG * h / 2, 1e-9);
    EXPECT_NEAR(a.v(0).y, b.v(0).y, 1e-9);
  }
  // Control: nine tenths of gravity are half a metre off.
  Rigid3dDef wrong = d;
  std::get<SphereBodyDef>(wrong.bodies[0]).gravity_scale = 0.9;
  EngineRun a = ours(d), b = theirs(wrong);
  a.seconds(1), b.seconds(1);
  EXPECT_GT(std::abs(a.x(0).y - b.x(0).y - kG / 120), 0.4);
}

TEST(Bullet, ABoxSlidesAsFar) {
  const auto distance = [](auto engine, double friction) {
    Rigid3dDef d;
    BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
    b.velocity = {3, 0, 0};
    d.bodies = {ground(), b}, d.friction = friction;
    EngineRun r = engine(d);
    r.seconds(2);
    EXPECT_LT(norm(r.v(1)), 1e-3);
    return r.x(1).x;
  };
  const auto own = [](const Rigid3dDef& d) { return ours(d); };
  const auto other = [](const Rigid3dDef& d) { return theirs(d); };
  // v^2 / (2 mu g), to within v h / 2 of the first step.
  const double expected = 9 / (2 * 0.5 * kG), tolerance = 3.0 / 120 + 0.005;
  EXPECT_NEAR(distance(own, 0.5), expected, tolerance);
  EXPECT_NEAR(distance(other, 0.5), expected, tolerance);
  EXPECT_GT(std::abs(distance(other, 0.6) - expected), tolerance);
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

TEST(Bullet, AStackOfBoxesStandsAtTheSameHeight) {
  Rigid3dDef d;
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->count = {1, 8, 1}, b.position.y = 0.5;
  d.bodies = {ground(), b};
  EngineRun x = ours(d), y = theirs(d);
  x.seconds(5), y.seconds(5);
  for (size_t i = 1; i < x.count(); ++i) {
    // Both let a contact sink by a few millimetres.
    EXPECT_NEAR(x.x(i).y, y.x(i).y, 0.005 * static_cast<double>(i)) << i;
    EXPECT_LT(std::hypot(y.x(i).x, y.x(i).z), 0.02) << i;
  }
  // Control: a shorter box is seen.
  EXPECT_GT(std::abs(x.x(8).y - 0.95 * y.x(8).y), 0.005 * 8);
}

enum class Filling : uint8_t { boxes, balls };

/// 64 bodies dropped between four walls.
Rigid3dDef heap_scene(Filling filling, double size, double friction, double shift = 0) {
  Rigid3dDef d;
  d.bodies = {ground()}, d.friction = friction;
  for (const double side : {-1.0, 1.0}) {
    for (const bool along_x : {true, false}) {
      BoxBodyDef wall = box(along_x ? Vec3{0.5, 5, 3} : Vec3{3, 5, 0.5},
                            along_x ? Vec3{2 * side, 5, 0} : Vec3{0, 5, 2 * side});
      wall.motion = BodyDef::Motion::fixed;
      d.bodies.push_back(wall);
    }
  }
  CopiesDef many;
  many.count = {4, 4, 4}, many.spacing = {0.7, 1.6, 0.7};
  many.jitter = 0.1, many.turn = CopiesDef::Turn::random;
  BoxBodyDef boxes = box({0.25 * size, 0.2 * size, 0.3 * size}, {shift, 1, 0});
  SphereBodyDef balls = ball(0.28 * size, {shift, 1, 0});
  boxes.copies = balls.copies = many;
  if (filling == Filling::boxes) {
    d.bodies.push_back(boxes);
  } else {
    d.bodies.push_back(balls);
  }
  return d;
}

struct Heap {
  double height = 0, kinetic = 0, penetration = 0;
};
Heap heap(EngineRun r) {
  r.seconds(6);
  double height = 0;
  for (size_t i = 5; i < r.count(); ++i) height += r.x(i).y / 64;
  return {height, r.observed("energy.kinetic"), r.observed("penetration")};
}

TEST(Bullet, HeapsWithoutFrictionSettleToTheSameStatistics) {
  for (const Filling f : {Filling::boxes, Filling::balls}) {
    // Each engine draws its own random numbers, and heaps of 64 scatter by some 2 %: the mean of six runs.
    Heap a, b;
    for (const double shift : {0.0, 0.01, 0.02, 0.03, 0.04, 0.05}) {
      const Heap x = heap(ours(heap_scene(f, 1, 0, shift))), y = heap(theirs(heap_scene(f, 1, 0, shift)));
      a.height += x.height / 6, b.height += y.height / 6;
      a.kinetic = std::max(a.kinetic, x.kinetic), b.kinetic = std::max(b.kinetic, y.kinetic);
      a.penetration = std::max(a.penetration, x.penetration);
    }
    // Bullet's boxes overlap slightly and keep settling for many seconds; balls reach the same height.
    EXPECT_NEAR(a.height, b.height, (f == Filling::balls ? 0.04 : 0.12) * a.height);
    // The fall released 150 kJ; frictionless boxes keep sliding slowly.
    EXPECT_LT(a.kinetic, 1500);
    EXPECT_LT(b.kinetic, 1500);
    // A body that still slides at half a metre per second moves 8 mm per step, and may be that deep before it
    // is pushed out; Bullet's boxes overlap by up to a decimetre where they are wedged in.
    EXPECT_LT(a.penetration, 0.025);
    // Control: bodies larger by a tenth have a third more volume.
    EXPECT_GT(heap(theirs(heap_scene(f, 1.1, 0))).height, 1.15 * b.height);
  }
}

TEST(Bullet, WithFrictionItsHeapsNearOursAsStepsShrink) {
  // With ten iterations per step friction creeps, so that Bullet's heaps are denser; less so with shorter
  // steps.
  const auto looser = [](double h) {
    return heap(ours(heap_scene(Filling::balls, 1, 0.5), h)).height /
           heap(theirs(heap_scene(Filling::balls, 1, 0.5), h)).height;
  };
  const double coarse = looser(1.0 / 60), fine = looser(1.0 / 480);
  EXPECT_LT(fine, 1.12);
  EXPECT_GT(coarse, fine);
}

TEST(Bullet, EveryShapeRestsAtItsHeight) {
  Rigid3dDef d;
  CapsuleBodyDef capsule;
  capsule.position = {4, 0.3, 0}, capsule.axis = {0, 0, 1}, capsule.angle = M_PI / 2;
  CylinderBodyDef cylinder;
  cylinder.position = {6, 0.6, 0};
  HullBodyDef hull;
  hull.position = {8, 0.1, 0};
  hull.points = {{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0, 0, 0.6}, {0, 1, 0}};
  CompoundBodyDef compound;
  compound.position = {10, 0.6, 0};
  BoxPartDef left, right;
  left.position = {-0.5, 0, 0}, right.position = {0.5, 0, 0};
  left.half_extents = right.half_extents = {0.3, 0.5, 0.4};
  compound.parts = {left, right};
  d.bodies = {ground(), ball(0.5, {0, 0.55, 0}), box({0.5, 0.3, 0.4}, {2, 0.35, 0}), capsule, cylinder, hull,
              compound};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(3), b.seconds(3);
  for (size_t i = 1; i < a.count(); ++i) {
    EXPECT_NEAR(a.x(i).y, b.x(i).y, 0.005) << i;
    EXPECT_LT(norm(b.v(i)), 0.01) << i;
  }
}

TEST(Bullet, MeshesAndHeightFieldsCarry) {
  Rigid3dDef d;
  MeshBodyDef mesh;
  mesh.motion = BodyDef::Motion::fixed;
  mesh.vertices = {{-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3}};
  mesh.triangles = {0, 2, 1, 0, 3, 2};
  HeightFieldBodyDef field;
  field.motion = BodyDef::Motion::fixed, field.position = {10, 0, 0};
  field.count = {3, 3}, field.spacing = 2, field.heights.assign(9, 0.25);
  d.bodies = {mesh, field, ball(0.5, {0.3, 0.6, 0.2}), ball(0.5, {10.2, 0.9, 0.3})};
  EngineRun b = theirs(d);
  b.seconds(2);
  EXPECT_NEAR(b.x(2).y, 0.5, 0.01);
  EXPECT_NEAR(b.x(3).y, 0.75, 0.01);
}

TEST(Bullet, SurfacesMixByTheScenesRules) {
  // Restitution: the larger value counts. A ball with 0.8 on a floor with 0 bounces to 0.64 of its height.
  const auto second_height = [](EngineRun r) {
    double top = 0;
    r.seconds(0.7);
    for (int k = 0; k < 60; ++k) r.run(1), top = std::max(top, r.x(1).y);
    return top;
  };
  Rigid3dDef d;
  SphereBodyDef b = ball(0.1, {0, 1.1, 0});
  b.restitution = 0.8;
  d.bodies = {ground(), b};
  // The time of the impact is known to within a step, that is v h = 4.4 m/s / 240 of height either way, and
  // Bullet's contacts begin 2 cm before the bodies touch.
  EXPECT_NEAR(second_height(ours(d, 1.0 / 240)), 0.74, 0.03);
  EXPECT_NEAR(second_height(theirs(d, 1.0 / 240)), 0.74, 0.03 + 0.02);
  std::get<SphereBodyDef>(d.bodies[1]).restitution = 0.6;
  EXPECT_LT(second_height(theirs(d, 1.0 / 240)), 0.6);
}

TEST(Bullet, KinematicBodiesPushAndSensorsDoNot) {
  Rigid3dDef d;
  BoxBodyDef pusher = box({0.2, 0.5, 1}, {-2, 0.5, 0}), ghost = box({0.5, 0.5, 0.5}, {3, 0.5, 0});
  pusher.motion = BodyDef::Motion::kinematic, pusher.velocity = {1, 0, 0};
  ghost.sensor = true, ghost.motion = BodyDef::Motion::fixed;
  d.bodies = {ground(), pusher, box({0.5, 0.5, 0.5}, {0, 0.5, 0}), ghost};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(4), b.seconds(4);
  EXPECT_NEAR(b.x(1).x, 2, 1e-9);
  EXPECT_NEAR(b.x(2).x, 2.7, 0.02);  // in front of the pusher, inside the sensor
  EXPECT_NEAR(a.x(2).x, b.x(2).x, 0.02);
  EXPECT_GE(b.observed("sensed"), 1);
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

TEST(Bullet, CommandsActAndARebuiltWorldGoesOn) {
  Rigid3dDef d;
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->count = {1, 4, 1};
  SphereBodyDef free = ball(0.2, {5, 60, 0});
  free.mass = 2;
  d.bodies = {ground(), b, free};
  EngineRun r = theirs(d);
  r.seconds(1);
  // The same state in a fresh workspace: free flight continues to the bit, and what stands keeps standing.
  EngineRun copy = theirs(d);
  copy.state = State::deserialize(r.state.serialize()), copy.step = r.step;
  r.run(20), copy.run(20);
  EXPECT_LT(norm(r.x(5) - copy.x(5)), 1e-12);
  for (size_t i = 1; i < 5;
       ++i)  // Without the warm-start impulses every contact gives way by a millimetre or two, once.
    EXPECT_LT(norm(r.x(i) - copy.x(i)), 2.5e-3 * static_cast<double>(i)) << i;

  Command c;
  c.kind = CommandKind::impulse, c.index = 5, c.vector = {4, 0, 0};
  const double before = r.v(5).x;
  r.system->apply(r.state, c);
  EXPECT_NEAR(r.v(5).x - before, 2, 1e-12);
  c.kind = CommandKind::push, c.vector = {0, 0, 6}, c.duration = 0.5;
  r.system->apply(r.state, c);
  const double z = r.v(5).z;
  r.run(3);
  EXPECT_NEAR(r.v(5).z - z, 3 * 3.0 / 60, 1e-9);
  c.kind = CommandKind::spawn, c.vector = {0, 20, 0};
  r.system->apply(r.state, c);
  r.run(1);
  EXPECT_EQ(r.count(), 7u);
  EXPECT_LT(r.x(6).y, 20);
  c.kind = CommandKind::remove, c.index = 1;
  r.system->apply(r.state, c);
  r.seconds(1);
  EXPECT_EQ(r.count(), 6u);
  EXPECT_LT(r.x(1).y, 0.6);  // the box above fell onto the ground
}

TEST(Bullet, RepeatsToTheBit) {
  const Rigid3dDef d = heap_scene(Filling::boxes, 1, 0.5);
  EngineRun a = theirs(d), b = theirs(d);
  a.seconds(1), b.seconds(1);
  EXPECT_EQ(a.state.hash(), b.state.hash());
}

TEST(Bullet, RefusesWhatItHasNoEquivalentOf) {
  Rigid3dDef d;
  MeshBodyDef mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  d.bodies = {ground(), mesh};
  EXPECT_NO_THROW(ours(d));
  try {
    theirs(d);
    FAIL() << "a dynamic mesh was taken";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/bodies/1/motion");
  }
}

}  // namespace
}  // namespace truestep::testing
