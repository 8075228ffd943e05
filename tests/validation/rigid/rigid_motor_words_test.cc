// Motors in the plane and in space take the same words: a motor joint drives velocities, and speeds, targets
// and maxima of motors are set while the scene runs. Joints without an anchor are in the middle.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

const std::string kMotorTypes[] = {"rigid2d", "rigid3d"};

/// A square or cube of 1 m and 2 kg at (3, 0, 0) without gravity, on a joint.
struct Driven {
  Driven(const std::string& type, const std::string& joint, const std::string& sleeping = "false",
         const std::string& more = "")
      : world(parse_scene(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [{"type": ")" + type +
                          R"(", "id": "r", "precision": "f64", "sleeping": )" + sleeping +
                          R"(, "bodies": [)" + body(type) + more +
                          R"(], "joints": [{"id": "j", "a": -1, "b": 0, )" + joint + "}]}]}")),
        state(world.initial_state()) {}
  static std::string body(const std::string& type, const std::string& at = "[3, 0, 0]") {
    return R"({"position": )" + at + R"(, "mass": 2, )" +
           (type == "rigid2d" ? R"("shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]})"
                              : R"("type": "box", "half_extents": [0.5, 0.5, 0.5]})");
  }
  void seconds(double s) {
    for (int k = 0; k < std::lround(s / 0.01); ++k) world.step(state, workspace, arena, {});
  }
  double observed(const std::string& name) { return world.observe(state).find("r." + name).value_or(NAN); }
  State& s() { return state.systems[0]; }
  Vec3 at(const char* field) { return load3<double>(s().f64(s().at(field)).data(), 0); }
  double spin() {
    const auto w = s().f64(s().at("angular_velocity"));
    return w.size() == 1 ? w[0] : w[2];
  }
  void set(const std::string& name, double value, Vec3 vector = {}) {
    Command c;
    c.kind = CommandKind::set_parameter, c.index = 0, c.name = name, c.value = value, c.vector = vector;
    world.system(0).apply(s(), c);
  }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

std::string hinge(const std::string& type, const std::string& more) {
  return R"("type": "revolute", "anchor": [3, 0, 0])" +
         std::string(type == "rigid2d" ? "" : R"(, "axis": [0, 0, 1])") + more;
}

TEST(MotorWords, AMotorsSpeedIsSetWhileTheSceneRuns) {
  for (const std::string& type : kMotorTypes) {
    Driven r(type, hinge(type, R"(, "motor_speed": 2)"));
    r.seconds(1);
    EXPECT_NEAR(r.observed("joint.j.angle"), 2, 0.01) << type;
    r.set("motor_speed", -1);
    r.seconds(1);
    EXPECT_NEAR(r.spin(), -1, 1e-6) << type;
    EXPECT_NEAR(r.observed("joint.j.angle"), 1, 0.03) << type;
    EXPECT_THROW(r.set("motor_target", 1), Error) << type << ": it has a speed";
    EXPECT_THROW(r.set("max_motor", -1), Error) << type;
    // A motor without strength lets it turn on.
    r.set("max_motor", 0), r.set("motor_speed", 5);
    r.seconds(1);
    EXPECT_NEAR(r.spin(), -1, 1e-6) << type;
    Driven free(type, hinge(type, ""));
    EXPECT_THROW(free.set("motor_speed", 1), Error) << type << ": it has no motor";
  }
}

TEST(MotorWords, AMotorsTargetIsSetWhileTheSceneRunsAndWakes) {
  for (const std::string& type : kMotorTypes) {
    Driven r(type, hinge(type, R"(, "motor_target": 0.5)"), "true");
    r.seconds(5);
    EXPECT_NEAR(r.observed("joint.j.angle"), 0.5, 1e-3) << type;
    EXPECT_EQ(r.observed("awake"), 0) << type;
    r.set("motor_target", -0.25);
    r.seconds(2);
    EXPECT_NEAR(r.observed("joint.j.angle"), -0.25, 1e-3) << type;
  }
}

TEST(MotorWords, AMotorJointsMoveIsSetWhileTheSceneRuns) {
  for (const std::string& type : kMotorTypes) {
    Driven r(type, R"("type": "motor", "move": [1, 0, 0], "max_force": 1000)");
    r.seconds(2);
    EXPECT_LT(norm(r.at("position") - Vec3{4, 0, 0}), 1e-3) << type;
    r.set("motor_target", 0, {0, -2, 0});
    r.seconds(2);
    EXPECT_LT(norm(r.at("position") - Vec3{3, -2, 0}), 1e-3) << type;
    EXPECT_THROW(r.set("motor_speed", 0, {1, 0, 0}), Error) << type;
  }
}

TEST(MotorWords, AMotorJointDrivesVelocities) {
  for (const std::string& type : kMotorTypes) {
    const std::string spin = type == "rigid2d" ? "0.5" : "[0, 0, 0.5]";
    Driven r(type, R"("type": "motor", "velocity": [0.5, 1, 0], "max_force": 4, "angular_velocity": )" +
                       spin + R"(, "max_torque": 0.1)");
    // With at most 4 N on 2 kg: 2 m/s^2 along its direction; with 0.1 N m on 1/3 kg m^2: 0.3 rad/s^2.
    r.seconds(0.25);
    EXPECT_NEAR(norm(r.at("velocity")), 0.5, 1e-6) << type;
    EXPECT_NEAR(r.spin(), 0.075, 1e-6) << type;
    r.seconds(2);
    EXPECT_LT(norm(r.at("velocity") - Vec3{0.5, 1, 0}), 1e-6) << type;
    EXPECT_NEAR(r.spin(), 0.5, 1e-6) << type;
    r.set("motor_speed", 0, {-1, 0, 0});
    r.seconds(2);
    EXPECT_LT(norm(r.at("velocity") - Vec3{-1, 0, 0}), 1e-6) << type;
    EXPECT_THROW(r.set("motor_target", 0, {1, 0, 0}), Error) << type;
  }
}

TEST(MotorWords, ADrivenVelocityKeepsItsBodyAwake) {
  for (const std::string& type : kMotorTypes) {
    // Slower than what may fall asleep.
    Driven r(type, R"("type": "motor", "velocity": [0.005, 0, 0])", "true");
    r.seconds(5);
    EXPECT_EQ(r.observed("awake"), 1) << type;
    EXPECT_NEAR(r.at("position").x, 3.025, 1e-4) << type;
  }
}

TEST(MotorWords, TwoFreeBodiesDrivenApartKeepTheirMomentum) {
  for (const std::string& type : kMotorTypes) {
    const std::string spin = type == "rigid2d" ? "0.4" : "[0, 0, 0.4]";
    Driven r(type,
             R"("type": "distance", "maximum": 100}, {"a": 0, "b": 1, "type": "motor",
                      "velocity": [0.3, 0.4, 0], "angular_velocity": )" +
                 spin,
             "false", ", " + Driven::body(type, "[5, 1, 0]"));
    r.seconds(2);
    for (const char* name : {"momentum.x", "momentum.y", "angular_momentum.z"}) {
      EXPECT_NEAR(r.observed(name), 0, 1e-6) << type << name;
    }
  }
}

TEST(MotorWords, AJointWithoutAnchorIsMidwayBetweenItsBodies) {
  for (const std::string& type : kMotorTypes) {
    const std::string axis = type == "rigid2d" ? "" : R"(, "axis": [0, 0, 1])";
    Driven r(type,
             R"("type": "revolute")" + axis + R"(}, {"a": 0, "b": 1, "id": "k", "type": "revolute")" + axis,
             "false", ", " + Driven::body(type, "[5, 0, 0]"));
    // Held by the world at its centre, 1 m from the joint of both.
    Command c;
    c.kind = CommandKind::impulse, c.index = 1, c.vector = {0, 1, 0}, c.at = Vec3{4, 0, 0};
    r.world.system(0).apply(r.s(), c);
    r.seconds(1);
    EXPECT_LT(norm(r.at("position") - Vec3{3, 0, 0}), 1e-3) << type;
    const Vec3 second = load3<double>(r.s().f64(r.s().at("position")).data(), 1);
    EXPECT_LT(norm(second - Vec3{3, 0, 0}), 2.001) << type;
    EXPECT_LT(r.observed("joints.gap"), 1e-3) << type;
    Driven line(type, R"("type": "distance")", "false", "");
    EXPECT_NEAR(line.observed("joint.j.length"), 3, 1e-12) << type << ": from the origin to its centre";
  }
}

}  // namespace
}  // namespace truestep
