// Joints take the same words in the plane and in space and do the same by them: springs by stiffness and
// damping, positions of rest, motors with a target, breaking torques, names that are observed.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/session/world/world.h"

namespace truestep {
namespace {

constexpr double kJointMass = 2, kJointGravity = 10;

struct Jointed {
  Jointed(const std::string& type, const std::string& joint, double gravity = kJointGravity)
      : world(parse_scene(R"({"gravity": [0, )" + std::to_string(-gravity) +
                          R"(, 0], "time": {"dt": 0.01}, "systems": [{"type": ")" + type +
                          R"(", "id": "r", "precision": "f64", "sleeping": false, "bodies": [)" + body(type) +
                          R"(], "joints": [{"id": "j", "a": -1, "b": 0, )" + joint + "}]}]}")),
        state(world.initial_state()) {}
  /// A square of 1 m, or a cube, around (0.5, 0, 0).
  static std::string body(const std::string& type) {
    return type == "rigid2d" ? R"({"position": [0.5, 0, 0], "mass": 2,
                                  "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]})"
                             : R"({"position": [0.5, 0, 0], "mass": 2,
                                  "type": "box", "half_extents": [0.5, 0.5, 0.5]})";
  }
  void seconds(double s) {
    for (int k = 0; k < std::lround(s / 0.01); ++k) world.step(state, workspace, arena, {});
  }
  double observed(const std::string& name) { return world.observe(state).find("r." + name).value_or(NAN); }
  std::vector<double> values(const std::string& part, const std::string& name) {
    const FieldView v = world.field(state, world.parts().find(part, name).value(), scratch);
    const auto* x = static_cast<const double*>(v.data);
    return {x, x + v.rows * v.width};
  }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
  std::vector<double> scratch;
};

const std::string kJointTypes[] = {"rigid2d", "rigid3d"};
const std::string kPin = R"("type": "revolute", "anchor": [0, 0, 0])";
// In space a hinge needs the direction that it has in the plane.
std::string hinge(const std::string& type) {
  return type == "rigid2d" ? kPin : kPin + R"(, "axis": [0, 0, 1])";
}

TEST(RigidJointWords, ASpringIsGivenByStiffnessAndDamping) {
  for (const std::string& type : kJointTypes) {
    // From the ceiling, 1 m above the body's centre: rest at m g / k.
    Jointed r(type, R"("type": "spring", "anchor": [0.5, 1, 0], "anchor_b": [0.5, 0, 0],
                       "stiffness": 200, "damping": 20)");
    r.seconds(4);
    EXPECT_NEAR(r.observed("joint.j.length"), 1 + kJointMass * kJointGravity / 200, 1e-6) << type;
    EXPECT_NEAR(r.observed("joint.j.force"), kJointMass * kJointGravity, 1e-3) << type;
    // Without damping it swings by as much, in a period of 2 pi sqrt(m / k) = 0.628 s.
    Jointed free(type,
                 R"("type": "spring", "anchor": [0.5, 1, 0], "anchor_b": [0.5, 0, 0], "stiffness": 200)");
    free.seconds(0.31);
    EXPECT_NEAR(free.observed("joint.j.length"), 1.2, 0.002) << type;
    const double energy = free.observed("energy.total");
    free.seconds(3.14);
    EXPECT_NEAR(free.observed("energy.total"), energy, 0.01 * kJointMass * kJointGravity * 0.1) << type;
  }
}

TEST(RigidJointWords, ASpringOfAHingeHasAPositionOfRest) {
  for (const std::string& type : kJointTypes) {
    Jointed r(type, hinge(type) + R"(, "stiffness": 50, "damping": 20, "rest": 0.4)", 0);
    EXPECT_NEAR(r.observed("energy.potential"), 0.5 * 50 * 0.4 * 0.4, 1e-12) << type;
    r.seconds(6);
    EXPECT_NEAR(r.observed("joint.j.angle"), 0.4, 1e-4) << type;
  }
}

TEST(RigidJointWords, AMotorApproachesItsTargetAtItsRate) {
  for (const std::string& type : kJointTypes) {
    for (const bool slides : {false, true}) {
      const std::string joint =
          slides ? R"("type": "prismatic", "anchor": [0, 0, 0], "axis": [1, 0, 0])" : hinge(type);
      Jointed r(type, joint + R"(, "motor_target": 0.5, "motor_rate": 8)");
      const std::string at = slides ? "joint.j.position" : "joint.j.angle";
      r.seconds(0.1);
      // Whatever the load, but for the first substeps, in which it gets to speed.
      EXPECT_NEAR(r.observed(at), 0.5 * (1 - std::exp(-0.8)), 0.01) << type << slides;
      r.seconds(2);
      EXPECT_NEAR(r.observed(at), 0.5, 1e-3) << type << slides;
    }
  }
}

TEST(RigidJointWords, AFixedJointBreaksByTheTorqueOnIt) {
  const double torque = kJointMass * kJointGravity * 0.5;
  for (const std::string& type : kJointTypes) {
    const std::string joint = R"("type": "fixed", "anchor": [0, 0, 0], "break_torque": )";
    // Loaded suddenly, too: force and torque are found together.
    Jointed first(type, joint + std::to_string(1.02 * torque));
    first.seconds(0.01);
    EXPECT_EQ(first.observed("joint.j.broken"), 0) << type;
    EXPECT_NEAR(first.observed("joint.j.torque"), torque, 0.001 * torque) << type;
    Jointed holds(type, joint + std::to_string(1.5 * torque)),
        breaks(type, joint + std::to_string(0.9 * torque));
    holds.seconds(1), breaks.seconds(1);
    EXPECT_EQ(holds.observed("joint.j.broken"), 0) << type;
    EXPECT_EQ(breaks.observed("joint.j.broken"), 1) << type;
    EXPECT_NEAR(holds.observed("joint.j.torque"), torque, 0.01 * torque) << type;
    EXPECT_NEAR(holds.observed("joints.torque"), torque, 0.01 * torque) << type;
    EXPECT_LT(holds.observed("joints.tilt"), 1e-3) << type;
    EXPECT_NEAR(holds.observed("joint.j.force"), kJointMass * kJointGravity,
                0.01 * kJointMass * kJointGravity)
        << type;
    // Fields: on the body, and on the joint's second body.
    for (const auto& force : {holds.values("r", "joint_force"), holds.values("r.joints", "force")}) {
      EXPECT_NEAR(force[1], kJointMass * kJointGravity, 0.01 * kJointMass * kJointGravity) << type;
    }
    for (const auto& turn : {holds.values("r", "joint_torque"), holds.values("r.joints", "torque")}) {
      EXPECT_NEAR(turn.back(), torque, 0.01 * torque) << type;
    }
  }
}

// A force along the axis of a slider, on its limit, counted for nothing in the plane.
TEST(RigidJointWords, ASliderBreaksByTheForceOnItsLimit) {
  for (const std::string& type : kJointTypes) {
    const std::string joint =
        R"("type": "prismatic", "anchor": [0.5, 0, 0], "axis": [0, 1, 0], "lower": 0, "break_force": )";
    Jointed holds(type, joint + std::to_string(1.5 * kJointMass * kJointGravity)),
        breaks(type, joint + std::to_string(0.8 * kJointMass * kJointGravity));
    holds.seconds(1), breaks.seconds(1);
    EXPECT_EQ(holds.observed("joint.j.broken"), 0) << type;
    EXPECT_EQ(breaks.observed("joint.j.broken"), 1) << type;
  }
}

TEST(RigidJointWords, AMotorJointMovesAndTurnsAtItsRate) {
  for (const std::string& type : kJointTypes) {
    const std::string turn = type == "rigid2d" ? "0.5" : "[0, 0, 0.5]";
    Jointed r(type,
              R"("type": "motor", "move": [0.4, 0.2, 0], "rate": 5, "max_force": 1e4, "max_torque": 1e4,
                       "turn": )" +
                  turn,
              0);
    r.seconds(0.2);
    EXPECT_NEAR(r.values("r", "position")[0], 0.5 + 0.4 * (1 - std::exp(-1.0)), 0.01) << type;
    r.seconds(3);
    EXPECT_NEAR(r.values("r", "position")[0], 0.9, 1e-3) << type;
    EXPECT_NEAR(r.values("r", "position")[1], 0.2, 1e-3) << type;
  }
}

}  // namespace
}  // namespace truestep
