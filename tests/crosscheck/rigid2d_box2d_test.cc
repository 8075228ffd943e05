// rigid2d compared with Box2D 2.4.1 (floats): the same positions at the same times for smooth motion, to the
// error of its first-order steps; the same statistics for chaotic motion.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/runs/engine_run.h"

namespace truestep::rigid2d {
namespace {

using truestep::testing::EngineRun;
using truestep::testing::ours;
using truestep::testing::theirs;

constexpr double kG = 9.81;

BodyDef body(ShapeDef shape, Vec3 at, Motion motion = Motion::dynamic) {
  BodyDef b;
  b.shapes = {std::move(shape)}, b.position = at, b.motion = motion;
  return b;
}
BodyDef box(Vec3 half, Vec3 at) {
  return body(BoxDef{half}, at);
}
BodyDef ground() {
  return body(BoxDef{{50, 1, 0}}, {0, -1, 0}, Motion::fixed);
}

/// Largest distance over all bodies in `seconds`, sampled twenty times.
double apart(const Rigid2dDef& d, const Rigid2dDef& peer, double h, double seconds) {
  EngineRun a = ours(d, h), b = theirs(peer, h);
  double most = 0;
  for (int k = 0; k < 20; ++k) {
    a.seconds(seconds / 20), b.seconds(seconds / 20);
    for (size_t i = 0; i < d.bodies.size(); ++i) most = std::max(most, norm(a.x(i) - b.x(i)));
  }
  return most;
}

TEST(Box2d, FreeFallDiffersByTheFirstOrderErrorOfItsSteps) {
  Rigid2dDef d;
  d.bodies = {box({0.5, 0.5, 0}, {0, 10, 0})};
  d.bodies[0].angular_velocity = 1, d.bodies[0].velocity = {2, 0, 0};
  EngineRun b = theirs(d);
  b.seconds(1);
  // Semi-implicit Euler falls g t h / 2 farther than the parabola; floats keep 1e-5 of 10 m.
  EXPECT_NEAR(b.x(0).y, 10 - kG / 2 - kG / 120, 1e-4);
  EXPECT_NEAR(b.x(0).x, 2, 1e-5);
  EXPECT_NEAR(b.angle(0), 1, 1e-5);
  // Ours follows the parabola.
  EngineRun a = ours(d);
  a.seconds(1);
  EXPECT_NEAR(a.x(0).y - b.x(0).y, kG / 120, 1e-4);
}

TEST(Box2d, ABoxSlidesAsFar) {
  const auto distance = [](double friction) {
    Rigid2dDef d;
    d.bodies = {ground(), box({0.5, 0.5, 0}, {0, 0.5, 0})};
    for (BodyDef& b : d.bodies) b.friction = friction;
    d.bodies[1].velocity = {3, 0, 0};
    EngineRun r = theirs(d);
    r.seconds(2);
    EXPECT_LT(norm(r.v(1)), 1e-3);
    return r.x(1).x;
  };
  const double expected = 9 / (2 * 0.5 * kG), tolerance = 3.0 / 120 + 0.005;
  EXPECT_NEAR(distance(0.5), expected, tolerance);
  EXPECT_GT(std::abs(distance(0.6) - expected), tolerance);
}

/// A body on each kind of joint whose path is smooth.
std::vector<std::pair<std::string, Rigid2dDef>> swinging() {
  std::vector<std::pair<std::string, Rigid2dDef>> out;
  const auto add = [&](const char* name, AnyJointDef joint) {
    Rigid2dDef d;
    d.bodies = {box({0.5, 0.1, 0}, {0.6, 0, 0})};
    d.sleeping = false, d.substeps = 16, d.precision = Precision::f64;
    std::visit(
        [](auto& j) {
          j.a = -1, j.b = 0;
          if (!j.anchor) j.anchor = Vec3{};
        },
        joint);
    d.joints = {joint};
    out.emplace_back(name, d);
  };
  add("revolute", RevoluteDef{});
  PrismaticDef slope;
  slope.axis = {1, 1, 0};
  add("prismatic", slope);
  DistanceDef rod;
  rod.anchor_b = {0.6, 0, 0};
  add("distance", rod);
  DistanceDef spring = rod;
  spring.hertz = 2, spring.damping_ratio = 0.1;
  add("spring", spring);
  WheelDef wheel;
  wheel.anchor = {0.6, 0, 0}, wheel.axis = {0, 1, 0}, wheel.hertz = 2;
  add("wheel", wheel);
  WeldDef weld;
  add("weld", weld);
  return out;
}

TEST(Box2d, JointsConvergeToTheSamePath) {
  for (const auto& [name, d] : swinging()) {
    const double coarse = apart(d, d, 1.0 / 240, 1.5), fine = apart(d, d, 1.0 / 960, 1.5);
    EXPECT_LT(fine, 0.02) << name;
    // First order, except for what floats and our soft constraints leave.
    EXPECT_LT(fine, 0.5 * coarse + 2e-3) << name;
    if (name == "weld") continue;  // does not move in either
    Rigid2dDef lighter = d;
    lighter.gravity = Vec3{0, -0.5 * kG, 0};
    EXPECT_GT(apart(d, lighter, 1.0 / 960, 1.5), 0.02) << name;
  }
}

TEST(Box2d, MotorsLimitsAndMiceDoTheSame) {
  Rigid2dDef d;
  d.bodies = {box({0.5, 0.1, 0}, {0, 0, 0}), box({0.5, 0.1, 0}, {5, 0, 0}), box({0.2, 0.2, 0}, {10, 0, 0}),
              box({0.2, 0.2, 0}, {15, 0, 0})};
  for (BodyDef& b : d.bodies) b.gravity_scale = 0;
  RevoluteDef motor, limited;
  motor.b = 0, motor.anchor = {0, 0, 0}, motor.motor_speed = 2;
  limited.b = 1, limited.anchor = {5, 0, 0}, limited.upper = 0.5;
  d.bodies[1].angular_velocity = 2;
  MouseDef mouse;
  mouse.b = 2, mouse.anchor = {10, 0, 0}, mouse.target = {10, 1, 0}, mouse.hertz = 1;
  MotorDef place;
  place.b = 3, place.move = {0, 0.5, 0}, place.turn = 0.3, place.max_force = 1e5, place.max_torque = 1e5;
  d.joints = {motor, limited, mouse, place};
  d.sleeping = false;
  EngineRun a = ours(d, 1.0 / 240), b = theirs(d, 1.0 / 240);
  a.seconds(2), b.seconds(2);
  for (const EngineRun* r : {&a, &b}) {
    EXPECT_NEAR(r->angle(0), 4, 0.02);    // 2 rad/s for 2 s
    EXPECT_NEAR(r->angle(1), 0.5, 0.02);  // stopped at the limit
    EXPECT_NEAR(r->x(2).y, 1, 0.01);      // at the target
    EXPECT_NEAR(r->x(3).y, 0.5, 0.01);
    EXPECT_NEAR(r->angle(3), 0.3, 0.01);
  }
}

TEST(Box2d, GearsAndPulleysCouple) {
  Rigid2dDef d;
  d.bodies = {body(CircleDef{0.5}, {0, 0, 0}), body(CircleDef{1}, {2, 0, 0}), box({0.2, 0.2, 0}, {8, 0, 0}),
              box({0.4, 0.2, 0}, {10, 0, 0})};
  d.bodies[0].angular_velocity = 2, d.bodies[1].angular_velocity = -1;
  RevoluteDef first, second;
  first.b = 0, second.b = 1, second.anchor = {2, 0, 0};
  GearDef gear;
  gear.a = 0, gear.b = 1, gear.ratio = 2;
  PulleyDef pulley;
  pulley.a = 2, pulley.b = 3, pulley.anchor = {8, 0.2, 0}, pulley.anchor_b = {10, 0.2, 0};
  pulley.ground_a = {8, 3, 0}, pulley.ground_b = {10, 3, 0};
  d.joints = {first, second, gear, pulley};
  d.sleeping = false;
  for (auto engine : {+[](const Rigid2dDef& s) { return ours(s, 1.0 / 240); },
                      +[](const Rigid2dDef& s) { return theirs(s, 1.0 / 240); }}) {
    EngineRun r = engine(d);
    r.seconds(0.5);
    EXPECT_NEAR(r.angle(0), 1, 0.02);
    EXPECT_NEAR(r.angle(0) + 2 * r.angle(1), 0, 0.01);
    // Atwood's machine: twice the weight on the right gives a third of g.
    EXPECT_NEAR(r.x(2).y, kG / 3 / 8, 0.02);
    EXPECT_NEAR(r.x(2).y + r.x(3).y, 0, 0.01);
  }
}

TEST(Box2d, APyramidStandsAtTheSameHeight) {
  Rigid2dDef d;
  PyramidDef p;
  p.body.shapes = {BoxDef{{0.5, 0.5, 0}}}, p.origin = {0, 0.5, 0}, p.spacing = {1.1, 1, 0}, p.base = 12;
  d.bodies = {ground()}, d.generators = {p};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(5), b.seconds(5);
  const size_t top = 78;
  // Box2D leaves 5 mm of overlap in every contact; ours sinks by less.
  EXPECT_NEAR(b.x(top).y, a.x(top).y, 0.005 * 12 + 0.01);
  EXPECT_LT(std::abs(b.x(top).x - a.x(top).x), 0.05);
  EXPECT_LT(b.observed("penetration"), 0.01);
  EXPECT_NEAR(b.observed("contacts"), a.observed("contacts"), 2);
  // Control: one row less is 1 m lower.
  EXPECT_GT(a.x(top).y - b.x(top - 1).y, 0.5);
}

TEST(Box2d, ShapesRestAtTheirHeights) {
  Rigid2dDef d;
  BoxDef rounded;
  rounded.half_extents = {0.4, 0.3, 0}, rounded.radius = 0.1;
  PolygonDef triangle;
  triangle.points = {{-0.5, 0, 0}, {0.5, 0, 0}, {0, 0.8, 0}};
  ChainDef floor;
  floor.points = {{-30, 0, 0}, {-5, 0, 0}, {5, 0, 0}, {30, 0, 0}};
  d.bodies = {body(floor, {0, 0, 0}, Motion::fixed), body(CircleDef{0.5}, {0, 0.6, 0}),
              body(CapsuleDef{}, {3, 0.3, 0}),       body(rounded, {6, 0.45, 0}),
              body(triangle, {9, 0.05, 0}),          box({0.5, 0.3, 0}, {12, 0.31, 0})};
  EngineRun a = ours(d), b = theirs(d);
  a.seconds(3), b.seconds(3);
  // Box2D leaves its slop of 5 mm.
  for (size_t i = 1; i < d.bodies.size(); ++i) EXPECT_NEAR(a.x(i).y, b.x(i).y, 0.007) << i;
}

TEST(Box2d, BeltsAndPlatformsToJumpThrough) {
  Rigid2dDef d;
  d.bodies = {ground(), box({1.2, 0.1, 0}, {0, 2.5, 0}), box({0.3, 0.3, 0}, {10, 0.3, 0}),
              body(CircleDef{0.25}, {0, 1, 0})};
  d.bodies[0].surface_speed = 1.5, d.bodies[0].friction = 0.8;
  d.bodies[1].motion = Motion::fixed, d.bodies[1].one_way = Vec3{0, 1, 0};
  d.bodies[3].velocity = {0, 7, 0};
  EngineRun a = ours(d, 1.0 / 240), b = theirs(d, 1.0 / 240);
  a.seconds(3), b.seconds(3);
  EXPECT_NEAR(b.v(2).x, 1.5, 0.01);
  EXPECT_NEAR(b.x(2).x, a.x(2).x, 0.03);
  EXPECT_NEAR(b.x(3).y, 2.85, 0.01);  // on the platform, through which it came
  d.bodies[1].one_way.reset();
  EngineRun solid = theirs(d, 1.0 / 240);
  solid.seconds(3);
  EXPECT_LT(solid.x(3).y, 1);
}

TEST(Box2d, GroupsSensorsAndBreakingJoints) {
  Rigid2dDef d;
  d.bodies = {ground(), box({0.5, 0.5, 0}, {0, 0.5, 0}), box({0.4, 0.4, 0}, {0, 2, 0}),
              body(CircleDef{1}, {5, 1, 0}, Motion::fixed), body(CircleDef{0.2}, {5, 3, 0})};
  d.bodies[1].group = d.bodies[2].group = -3, d.bodies[3].sensor = true;
  RevoluteDef weak;
  weak.b = 4, weak.anchor = {5, 3, 0}, weak.break_force = 0.5 * 0.04 * M_PI * 1000 * kG;
  d.joints = {weak};
  EngineRun r = theirs(d);
  r.seconds(2);
  EXPECT_NEAR(r.x(2).y, 0.4, 0.01);  // inside the other, on the ground
  EXPECT_EQ(r.observed("joints.broken"), 1);
  EXPECT_NEAR(r.x(4).y, 0.2, 0.01);
  EXPECT_EQ(r.observed("sensed"), 1);
}

TEST(Box2d, CommandsActAndARebuiltWorldGoesOn) {
  Rigid2dDef d;
  WallDef wall;
  wall.body.shapes = {BoxDef{{0.5, 0.5, 0}}}, wall.origin = {0, 0.5, 0}, wall.nx = 1, wall.ny = 4;
  wall.spacing = {0, 1, 0};
  d.bodies = {ground(), body(CircleDef{0.5}, {8, 50, 0})}, d.generators = {wall};
  d.bodies[1].mass = 2;
  EngineRun r = theirs(d);
  r.seconds(1);
  EngineRun copy = theirs(d);
  copy.state = State::deserialize(r.state.serialize()), copy.steps = r.steps;
  r.run(20), copy.run(20);
  EXPECT_LT(norm(r.x(1) - copy.x(1)), 1e-5);
  for (size_t i = 2; i < 6; ++i) EXPECT_LT(norm(r.x(i) - copy.x(i)), 3e-3) << i;

  Command c;
  c.kind = CommandKind::impulse, c.index = 1, c.vector = {4, 0, 0};
  r.system->apply(r.state, c);
  EXPECT_NEAR(r.v(1).x, 2, 1e-6);
  c.kind = CommandKind::push, c.vector = {6, 0, 0}, c.duration = 0.05;
  r.system->apply(r.state, c);
  r.run(10);
  EXPECT_NEAR(r.v(1).x, 2 + 3 * 3.0 / 60, 1e-5);
  c.kind = CommandKind::drag, c.vector = {20, 20, 0}, c.value = 0;
  r.system->apply(r.state, c);
  r.seconds(4);
  EXPECT_NEAR(r.x(1).x, 20, 0.1);
  c.kind = CommandKind::release;
  r.system->apply(r.state, c);
  c.kind = CommandKind::pin, c.index = 5;
  r.system->apply(r.state, c);
  c.kind = CommandKind::remove, c.index = 4;
  r.system->apply(r.state, c);
  const double held = r.x(5).y;
  r.seconds(1);
  EXPECT_EQ(r.x(5).y, held);  // pinned in the air
  c.kind = CommandKind::unpin, c.index = 5;
  r.system->apply(r.state, c);
  r.seconds(2);
  EXPECT_NEAR(r.x(5).y, 2.5, 0.03);  // fell onto the second box
}

// A box of 0.5 m x 1 m at the end of a joint: the loads of statics, from both engines.
TEST(Box2d, JointsReportTheSameLoads) {
  const double weight = 1000 * 0.5 * kG;
  WeldDef weld;
  weld.id = "j", weld.b = 0, weld.anchor = Vec3{};
  PrismaticDef rail;
  rail.id = "j", rail.b = 0, rail.anchor = Vec3{}, rail.axis = {0, 1, 0}, rail.lower = 0.0;
  DistanceDef rod;
  rod.id = "j", rod.b = 0, rod.anchor = {1, 2, 0}, rod.anchor_b = {1, 0, 0};
  const std::pair<AnyJointDef, double> joints[] = {{weld, weight * 1}, {rail, weight * 1}, {rod, 0}};
  for (const auto& [joint, torque] : joints) {
    Rigid2dDef d;
    d.bodies = {box({0.5, 0.25, 0}, {1, 0, 0})};
    d.joints = {joint};
    d.sleeping = false;
    const auto judge = [&, &torque = torque, &joint = joint](EngineRun run) {
      run.seconds(2);
      // Box2D counts in floats and ends its iterations early.
      EXPECT_NEAR(run.observed("joint.j.force"), weight, 0.01 * weight) << joint.index();
      EXPECT_NEAR(run.observed("joint.j.torque"), torque, 0.01 * weight) << joint.index();
    };
    judge(ours(d, 1.0 / 240)), judge(theirs(d, 1.0 / 240));
  }
}

TEST(Box2d, RefusesWhatItHasNoEquivalentOf) {
  Rigid2dDef d;
  d.bodies = {box({0.5, 0.5, 0}, {0, 0, 0}), box({0.5, 0.5, 0}, {3, 0, 0})};
  d.bodies[0].rolling_resistance = 0.1;
  RevoluteDef sprung;
  sprung.b = 0, sprung.hertz = 2.0;
  GearDef gear;
  gear.a = 0, gear.b = 1;
  d.joints = {sprung, gear};
  EXPECT_NO_THROW(ours(d));
  try {
    theirs(d);
    FAIL() << "it was taken";
  } catch (const Error& e) {
    std::vector<std::string> pointers;
    for (const Issue& i : e.issues()) pointers.push_back(i.pointer);
    EXPECT_EQ(pointers,
              (std::vector<std::string>{"/bodies/0/rolling_resistance", "/joints/0/hertz", "/joints/1/b"}));
  }
}

}  // namespace
}  // namespace truestep::rigid2d
