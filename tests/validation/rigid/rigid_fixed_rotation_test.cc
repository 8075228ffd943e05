// A body with fixed_rotation never rotates, in the plane and in space: not by impulses off its centre, not on
// a corner, not where a rope pulls at one. It moves as if its inertia were infinite.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

const std::string kRotationTypes[] = {"rigid2d", "rigid3d"};
constexpr double kTilt = 0.5;  // rad

/// A box of 1 m with 2 kg at the height y, turned by kTilt about z, above a floor whose top is at y = 0.
struct RotationTrial {
  RotationTrial(const std::string& type, double y, const std::string& more, const std::string& system = "",
                const std::string& scene = "", double gravity = 10)
      : world(parse_scene(text(type, y, more, system, scene, gravity))), state(world.initial_state()) {}
  static std::string text(const std::string& type, double y, const std::string& more,
                          const std::string& system, const std::string& scene, double gravity) {
    const bool flat = type == "rigid2d";
    const auto box = [&](const char* half) {
      const std::string size = R"("type": "box", "half_extents": )" + std::string(half);
      return flat ? R"("shapes": [{)" + size + "}]" : size;
    };
    const std::string turned =
        R"("angle": )" + std::to_string(kTilt) + (flat ? "" : R"(, "axis": [0, 0, 1])");
    return R"({"gravity": [0, )" + std::to_string(-gravity) +
           R"(, 0], "time": {"dt": 0.01}, "systems": [{"type": ")" + type +
           R"(", "id": "r", "bodies": [{"motion": "fixed", "position": [0, -0.5, 0], )" + box("[5, 0.5, 5]") +
           R"(}, {"mass": 2, "position": [0, )" + std::to_string(y) + ", 0], " + turned + ", " +
           box("[0.5, 0.5, 0.5]") + more + "}]" + system + "}" + (scene.empty() ? "]" : scene + "]") + "}";
  }
  RotationTrial& seconds(double s) {
    for (int k = 0; k < std::lround(s / 0.01); ++k) world.step(state, workspace, arena, {});
    return *this;
  }
  State& s() { return state.systems[0]; }
  double coordinate(const char* field, size_t k) { return s().f64(s().at(field))[3 + k]; }
  /// rad/s, of the box.
  double spin() {
    const auto w = s().f64(s().at("angular_velocity"));
    return w.size() == 2 ? std::abs(w[1]) : norm(load3<double>(w.data(), 1));
  }
  double observed(const std::string& name) { return world.observe(state).find("r." + name).value_or(NAN); }
  void apply(const Command& c) { world.system(0).apply(s(), c); }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

const std::string kFixed = R"(, "fixed_rotation": true)";

TEST(FixedRotation, ImpulsesAndPushesOffTheCentreOnlyMoveIt) {
  for (const std::string& type : kRotationTypes) {
    for (const bool fixed : {true, false}) {
      RotationTrial t(type, 3, fixed ? kFixed : "", "", "", 0);
      Command c;
      c.kind = CommandKind::impulse, c.index = 1, c.vector = {4, 0, 0}, c.at = Vec3{0, 3.4, 0};
      t.apply(c);
      c.kind = CommandKind::push, c.duration = 0.5;
      t.apply(c);
      t.seconds(1);
      // v = (J + F t) / m.
      EXPECT_NEAR(t.coordinate("velocity", 0), (4 + 4 * 0.5) / 2, 5e-5) << type << ": 200 sums of floats";
      EXPECT_EQ(t.spin() == 0, fixed) << type << ": the other is the control";
    }
  }
}

TEST(FixedRotation, ABoxStandsOnACornerAndSleepsThere) {
  // Half the diagonal's height when turned.
  const double height = 0.5 * (std::cos(kTilt) + std::sin(kTilt));
  for (const std::string& type : kRotationTypes) {
    for (const char* precision : {"f32", "f64"}) {
      const std::string system = R"(, "precision": ")" + std::string(precision) + "\"";
      RotationTrial t(type, 1, kFixed, system);
      t.seconds(4);
      EXPECT_NEAR(t.coordinate("position", 1), height, 1e-3) << type << precision;
      EXPECT_EQ(t.spin(), 0) << type << precision;
      EXPECT_EQ(t.observed("awake"), 0) << type << precision;
      RotationTrial control(type, 1, "", system);
      EXPECT_NEAR(control.seconds(4).coordinate("position", 1), 0.5, 0.01) << type << precision;
    }
  }
}

TEST(FixedRotation, ABoxSlidesDownAsAPointDoes) {
  // Off a fixed edge of the slope nothing tips it: flat on the floor, thrown along it, it stops after
  // v^2 / (2 mu g), wherever friction acts.
  for (const std::string& type : kRotationTypes) {
    RotationTrial t(type, 0.5 * (std::cos(kTilt) + std::sin(kTilt)),
                    kFixed + R"(, "velocity": [2, 0, 0], "friction": 0.5)", R"(, "sleeping": false)");
    t.seconds(2);
    // Within half a step's way, on which it may slide until it is supported: v dt / 2.
    EXPECT_NEAR(t.coordinate("position", 0), 2 * 2 / (2 * 0.5 * 10), 0.01) << type;
  }
}

TEST(FixedRotation, JointsHoldItByForcesAlone) {
  for (const std::string& type : kRotationTypes) {
    for (const std::string joint : {"fixed", "revolute", "prismatic"}) {
      const std::string axis = joint == "prismatic"                       ? R"(, "axis": [1, 0, 0])"
                               : joint == "revolute" && type == "rigid3d" ? R"(, "axis": [0, 0, 1])"
                                                                          : "";
      RotationTrial t(type, 3, kFixed,
                      R"(, "sleeping": false, "joints": [{"id": "j", "type": ")" + joint +
                          R"(", "a": -1, "b": 1, "anchor": [0.5, 3, 0])" + axis + "}]");
      t.seconds(2);
      EXPECT_NEAR(t.observed("joint.j.force"), 20, 0.01) << type << joint;
      EXPECT_EQ(t.spin(), 0) << type << joint;
      EXPECT_NEAR(t.coordinate("position", 1), 3, 1e-3) << type << joint;
      // What holds the rotation is not the joint.
      EXPECT_NEAR(t.observed("joint.j.torque"), 0, 1e-3) << type << joint;
    }
  }
}

TEST(FixedRotation, ARopeAtItsCornerOnlyLiftsIt) {
  // From (0.5, 6, 0), 2 m down to the corner; what is attached to a corner swings, and turns if it may.
  for (const std::string& type : kRotationTypes) {
    for (const char* link :
         {R"("link": "rigid")", R"("link": "spring", "stiffness": 20000, "damping": 20)"}) {
      const std::string more =
          std::string(R"(, {"type": "mass_spring", "id": "rope", "rope": {"from": [0.5, 6, 0],
          "to": [0.5, 4, 0], "links": 10}, "mass": 0.1, "stiffness": 20000, "damping": 0.5, "pinned": ["first"]}],
          "couplings": [{"type": "attachment", "id": "hook", "a": "rope", "b": "r", )") +
          link + R"(, "a_points": [-1], "b_points": [1], "places": [[0.5, 4, 0]]})";
      for (const bool fixed : {true, false}) {
        RotationTrial t(type, 3.6, fixed ? kFixed : "", R"(, "sleeping": false)", more);
        t.seconds(1);
        EXPECT_EQ(t.spin() < 1e-12, fixed) << type << link;
        EXPECT_GT(t.coordinate("position", 1), 3) << type << link;
        EXPECT_LT(std::abs(t.observed("energy.kinetic")), 40) << type << link;
      }
    }
  }
}

TEST(FixedRotation, ItHasNeitherAnInertiaNorAnAngularVelocity) {
  for (const std::string& type : kRotationTypes) {
    const bool flat = type == "rigid2d";
    EXPECT_NO_THROW(RotationTrial(type, 1, kFixed));
    EXPECT_THROW(RotationTrial(type, 1, kFixed + R"(, "inertia": )" + (flat ? "1" : "[1, 1, 1]")), Error)
        << type;
    EXPECT_THROW(RotationTrial(type, 1, kFixed + R"(, "angular_velocity": )" + (flat ? "1" : "[0, 0, 1]")),
                 Error)
        << type;
    RotationTrial t(type, 1, kFixed);
    Command c;
    c.kind = CommandKind::set_parameter, c.index = 1, c.name = "angular_velocity", c.value = 1,
    c.vector = {0, 0, 1};
    EXPECT_THROW(t.apply(c), Error) << type;
  }
}

}  // namespace
}  // namespace truestep
