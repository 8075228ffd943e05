// Errors in joints with their pointers; commands to motors; coordinates of joints.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/scene/json/json.h"
#include "engine/scene/params/params.h"
#include "engine/session/world/world.h"
#include "tests/support/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

/// Two dynamic balls, rows 0 and 1, and a plane, row 2.
std::string scene(const std::string& joints) {
  return R"({"systems": [{"type": "rigid3d", "id": "r", "bodies": [
    {"type": "sphere", "position": [0, 2, 0], "copies": {"count": [2, 1, 1], "spacing": [2, 1, 1]}},
    {"type": "plane", "motion": "fixed"}], "joints": )" +
         joints + "}]}";
}

std::vector<Issue> faults(const std::string& joints) {
  try {
    const World world(parse_scene(scene(joints)));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "scene_invalid");
    return e.issues();
  }
  return {};
}

TEST(Rigid3dJointScene, EveryFaultHasItsPointer) {
  struct Case {
    const char* joint;
    const char* pointer;
  };
  for (
      const Case& c : {
          Case{R"([{"type": "bal"}])", "/0/type"},
          Case{R"([{"type": "ball", "a": 0, "b": 7}])", "/0/b"},
          Case{R"([{"type": "ball", "a": -2, "b": 0}])", "/0/a"},
          Case{R"([{"type": "ball", "a": 0, "b": 1, "repeat": 3}])", "/0/b"},
          Case{R"([{"type": "ball", "a": 1, "b": 1}])", "/0/b"},
          Case{R"([{"type": "ball", "a": 0, "b": 1, "break_force": 0}])", "/0/break_force"},
          Case{
              R"([{"type": "ball", "a": 0, "b": 1, "id": "x"}, {"type": "ball", "a": -1, "b": 1, "id": "x"}])",
              "/1/id"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1, "axis": [0, 0, 0]}])", "/0/axis"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1, "lower": 1, "upper": -1}])", "/0/lower"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1, "hertz": 1, "stiffness": 3}])", "/0/hertz"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1, "motor_speed": 1, "motor_target": 3}])",
               "/0/motor_target"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1, "max_motor": 1}])", "/0/max_motor"},
          Case{R"([{"type": "slider", "a": 0, "b": 1, "stiffness": -1}])", "/0/stiffness"},
          Case{R"([{"type": "slider", "a": 0, "b": 1, "axis": [0, 0, 0]}])", "/0/axis"},
          Case{R"([{"type": "cylindrical", "a": 0, "b": 1, "slide": {"lower": 2, "upper": 1}}])",
               "/0/slide/lower"},
          Case{R"([{"type": "plane", "a": 0, "b": 1, "axis": [0, 0, 0]}])", "/0/axis"},
          Case{R"([{"type": "distance", "a": 0, "b": 1, "minimum": 2, "maximum": 1}])", "/0/minimum"},
          Case{R"([{"type": "distance", "a": 0, "b": 1, "length": 2, "maximum": 1}])", "/0/length"},
          Case{R"([{"type": "spring", "a": 0, "b": 1}])", "/0/stiffness"},
          Case{R"([{"type": "spring", "a": 0, "b": 1, "hertz": 2, "damping": 1}])", "/0/hertz"},
          Case{R"([{"type": "universal", "a": 0, "b": 1, "axis": [1, 0, 0], "axis_b": [1, 1, 0]}])",
               "/0/axis_b"},
          Case{R"([{"type": "cone_twist", "a": 0, "b": 1, "swing": 4}])", "/0/swing"},
          Case{R"([{"type": "cone_twist", "a": 0, "b": 1, "twist_lower": 1, "twist_upper": 0}])",
               "/0/twist_lower"},
          Case{R"([{"type": "six_dof", "a": 0, "b": 1, "across": [2, 0, 0]}])", "/0/across"},
          Case{R"([{"type": "six_dof", "a": 0, "b": 1, "turn_z": {"lower": 1, "upper": 0}}])",
               "/0/turn_z/lower"},
          Case{R"([{"type": "motor", "a": 0, "b": 1, "turn": [4, 0, 0]}])", "/0/turn"},
          Case{R"([{"type": "gear", "first": 0, "second": 1}])", "/0/first"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1}, {"type": "gear", "first": 0, "second": 4}])",
               "/1/second"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1}, {"type": "gear", "first": 0, "second": 0}])",
               "/1/second"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1}, {"type": "ball", "a": -1, "b": 1},
                    {"type": "gear", "first": 0, "second": 1}])",
               "/2/second"},
          Case{R"([{"type": "hinge", "a": 0, "b": 1}, {"type": "hinge", "a": -1, "b": 1},
                    {"type": "gear", "first": 0, "second": 1, "ratio": 0}])",
               "/2/ratio"},
      }) {
    const auto found = faults(c.joint);
    ASSERT_FALSE(found.empty()) << c.joint;
    EXPECT_EQ(found[0].pointer, std::string("/systems/0/joints") + c.pointer) << c.joint << found[0].message;
    EXPECT_FALSE(found[0].message.empty());
  }
  // The control: a valid joint is accepted.
  EXPECT_TRUE(faults(R"([{"type": "hinge", "a": 0, "b": 1, "lower": -1, "upper": 1, "hertz": 1},
    {"type": "hinge", "a": -1, "b": 1}, {"type": "gear", "first": 0, "second": 1, "ratio": 2},
    {"type": "ball", "a": -1, "b": 2}])")
                  .empty());
}

TEST(Rigid3dJointCommands, MotorsTakeTheirTargetsAndOthersRefuse) {
  Rigid3dDef d;
  d.bodies = {testing::ball(0.5, {0, 1, 0}), testing::ball(0.5, {2, 1, 0})};
  HingeJointDef hinge;
  hinge.id = "h", hinge.motor_speed = 1, hinge.max_motor = 1e6;
  BallJointDef plain;
  plain.b = 1;
  d.joints = {hinge, plain};
  testing::RigidRun run(d);
  Command c;
  c.kind = CommandKind::set_parameter, c.name = "motor_speed", c.index = 0, c.value = -3;
  run.apply(c);
  run.run(30);
  EXPECT_NEAR(run.w(0).y, -3, 1e-4);
  c.name = "max_motor", c.value = 0;
  run.apply(c);
  c.name = "motor_speed", c.value = 10;
  run.apply(c);
  run.run(30);
  EXPECT_NEAR(run.w(0).y, -3, 1e-2);  // without strength nothing changes
  const auto refused = [&](const char* name, int64_t index, double value) {
    c.name = name, c.index = index, c.value = value;
    try {
      run.apply(c);
    } catch (const Error& e) {
      return e.code() == "bad_command" && !e.issues().empty();
    }
    return false;
  };
  EXPECT_TRUE(refused("motor_speed", 1, 1));   // no motor
  EXPECT_TRUE(refused("motor_speed", 2, 1));   // no joint
  EXPECT_TRUE(refused("motor_target", 0, 1));  // wants a speed
  EXPECT_TRUE(refused("max_motor", 0, -1));
}

TEST(Rigid3dJointPlace, RatesOfCoordinatesAreTheirAxes) {
  // d coordinate / dt = turn axis . (w_b - w_a), by differences, for every definition of the rotation.
  Joint j;
  j.anchor_a = {0.1, 0.2, 0.3}, j.anchor_b = {-0.2, 0.1, 0};
  const Quat qa = normalized(Quat{0.9, 0.2, -0.3, 0.1}), qb = normalized(Quat{0.8, -0.1, 0.25, 0.4});
  const Vec3 w{0.3, -0.7, 0.5};
  const double h = 1e-6;
  const Quat later = normalized(Quat{1, 0.5 * h * w.x, 0.5 * h * w.y, 0.5 * h * w.z} * qb);
  for (const auto form : {Joint::Form::cardan, Joint::Form::swing_twist}) {
    j.form = form;
    const JointPlace before = joint_place(j, {{}, qa}, {{1, 0, 0}, qb}),
                     after = joint_place(j, {{}, qa}, {{1, 0, 0}, later});
    for (int e = 0; e < (form == Joint::Form::cardan ? 3 : 2); ++e) {
      EXPECT_NEAR((after.coordinate[3 + e] - before.coordinate[3 + e]) / h, dot(before.turns[e], w), 1e-5)
          << e;
    }
  }
  EXPECT_NEAR(unwrapped(-3, 100), -3 + 16 * 2 * M_PI, 1e-12);
}

TEST(SoftConstraint, TheOscillatorsStepIsStableAndDampsByItsRate) {
  for (const double w : {0.1, 10.0, 1e3, 1e6}) {
    for (const double zeta : {0.0, 0.1, 1.0, 30.0}) {
      const double h = 1.0 / 300;
      const OscillatorStep s = oscillator_step(w * w, 2 * zeta * w, h);
      // Eigenvalues of (v, x) -> ((1 - scale) v - push x, x + h v+): product and sum within the unit circle.
      const double product = 1 - s.scale, sum = 1 - h * s.push + product;
      EXPECT_LE(product, 1 + 1e-15);
      EXPECT_LE(std::abs(sum), 1 + product + 1e-12);
      if (w * h < 0.5) {
        EXPECT_NEAR(product, std::exp(-2 * zeta * w * h), 1e-12);
      }
    }
  }
}

/// x(1) of x'' = -w^2 x from (1, 2) in steps of h, with half a kick at both ends or without.
TEST(SoftConstraint, TheOscillatorsStepIsOfSecondOrderBetweenHalfPulls) {
  const double w = 9;
  const auto error = [&](double h, double halves) {
    const OscillatorStep s = oscillator_step(w * w, 0, h);
    double x = 1, v = 2 + halves * s.half;
    const int steps = static_cast<int>(1 / h + 0.5);
    for (int k = 0; k < steps; ++k) v = (1 - s.scale) * v - s.push * x, x += h * v;
    v -= halves * s.half * x;
    const double off = x - (std::cos(w) + 2 / w * std::sin(w));
    return std::hypot(off, (v - (2 * std::cos(w) - w * std::sin(w))) / w);
  };
  EXPECT_NEAR(std::log2(error(1e-3, 1) / error(5e-4, 1)), 2, 0.05);
  // The control: without them it is symplectic Euler's.
  EXPECT_NEAR(std::log2(error(1e-3, 0) / error(5e-4, 0)), 1, 0.05);
  EXPECT_EQ(oscillator_step(1e6, 0, 1.0 / 300).half, 0);
}

/// A spring given by hertz has the stiffness that gives its bodies that frequency in their configuration at t
/// = 0.
TEST(RigidJoints, ASpringByHertzHasOneStiffness) {
  Rigid3dDef d;
  SphereBodyDef ball;
  ball.mass = 2;
  d.bodies.push_back(ball);
  ball.mass = 3, ball.position = {2, 0, 0}, ball.radius = 0.4;
  d.bodies.push_back(ball);
  SpringJointDef spring;
  spring.a = 0, spring.b = 1, spring.hertz = 1.5, spring.damping_ratio = 0.1;
  spring.anchor = Vec3{0, 0.3, 0}, spring.anchor_b = Vec3{2, 0.3, 0};
  d.joints.push_back(spring);
  const JointList joints = build_joints(d, build_bodies(d, 1));
  // 0.3 m from both centres, 2/5 m r^2 of a ball.
  const double k = 1.0 / 2 + 1.0 / 3 + 0.09 / (0.4 * 2 * 0.25) + 0.09 / (0.4 * 3 * 0.16), w = 2 * M_PI * 1.5;
  ASSERT_EQ(joints.drives.size(), 1u);
  EXPECT_NEAR(joints.drives[0].stiffness, w * w / k, 1e-9 * w * w);
  EXPECT_NEAR(joints.drives[0].damping, 0.2 * w / k, 1e-9 * w);
}

}  // namespace
}  // namespace truestep
