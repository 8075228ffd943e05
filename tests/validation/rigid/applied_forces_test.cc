// Constant forces and torques on bodies and links, and prescribed inertias: motions in closed form, free and
// in contact, in the world's axes and in the body's own; energy.total and power.applied account for them.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/json/json.h"
#include "tests/support/world_run.h"

namespace truestep {
namespace {

struct Trial : testing_rig::WorldRun {
  Trial(const std::string& system, double dt = 0.01)
      : WorldRun(R"({"gravity": [0, 0, 0], "time": {"dt": )" + std::to_string(dt) + R"(}, "systems": [)" +
                 system + "]}") {}
  double field(const std::string& name, size_t k) {
    std::vector<double> scratch;
    return element(world.field(state, world.parts().find(world.id(0), name).value(), scratch), k);
  }
};

std::string body3(const std::string& more, const std::string& others = "", const std::string& system = "") {
  return R"({"type": "rigid3d", "id": "r", "bodies": [{"type": "box", "half_extents": [0.5, 0.5, 0.5], "mass": 2, )" +
         more + "}" + others + "]" + system + "}";
}
std::string body2(const std::string& more, const std::string& others = "") {
  return R"({"type": "rigid2d", "id": "r", "precision": "f64", "bodies": [{"shapes": [{"type": "box"}], "mass": 2, )" +
         more + "}" + others + "]}";
}

TEST(AppliedForces, AFreeBodyAcceleratesAndKeepsItsTotalEnergy) {
  for (const std::string& scene : {body3(R"("force": [3, 0, -1], "velocity": [0, 1, 0])"),
                                   body2(R"("force": [3, -1, 0], "velocity": [0, 1, 0])")}) {
    Trial run(scene);
    const double before = run.observed("energy.total");
    run.steps(200);
    EXPECT_NEAR(run.field("velocity", 0), 3.0 / 2 * 2, 1e-9);
    // Exact in space; in the plane the substeps of 2.5 ms are of first order.
    const bool flat = scene.find("rigid2d") != std::string::npos;
    EXPECT_NEAR(run.field("position", 0), 3.0 / 2 * 2, flat ? 0.004 : 1e-9);
    EXPECT_NEAR(run.observed("energy.total"), before, flat ? 0.02 : 1e-9);
    EXPECT_GT(run.observed("energy.kinetic"), 9);
  }
}

TEST(AppliedForces, ATorqueTurnsTheInertiaThatIsGiven) {
  const double torque = 0.6, inertia = 1.5, t = 2, rate = torque * t / inertia;
  Trial space(body3(R"("inertia": [1.2, 1.4, 1.5], "torque": [0, 0, 0.6])"));
  space.steps(200);
  EXPECT_NEAR(space.field("angular_velocity", 2), rate, 1e-9);
  EXPECT_NEAR(space.observed("energy.kinetic"), 0.5 * inertia * rate * rate, 1e-9);
  EXPECT_NEAR(space.observed("power.applied"), torque * rate, 1e-9);
  // The tensor's axes are the shape's: turned by 90 degrees about y, its x axis is the world's -z.
  Trial turned(
      body3(R"("axis": [0, 1, 0], "angle": "90 deg", "inertia": [1.5, 1.4, 1.2], "torque": [0, 0, 0.6])"));
  turned.steps(200);
  EXPECT_NEAR(turned.field("angular_velocity", 2), rate, 1e-9);
  Trial plane(body2(R"("inertia": 1.5, "torque": 0.6)"));
  const double before = plane.observed("energy.total");
  plane.steps(200);
  EXPECT_NEAR(plane.field("angular_velocity", 0), rate, 1e-6);
  EXPECT_NEAR(plane.observed("energy.kinetic"), 0.5 * inertia * rate * rate, 1e-5);
  EXPECT_NEAR(plane.observed("energy.total"), before, 1e-3);  // first order: torque^2 t h / (2 I)
  Trial link(
      R"({"type": "articulation", "id": "r", "links": [{"mass": 1, "inertia": [1.2, 1.4, 1.5], "axis": [0, 0, 1],
               "moment": [0, 0, 0.6]}]})");
  link.steps(200);
  EXPECT_NEAR(link.field("angular_velocity", 2), rate, 1e-9);
  EXPECT_NEAR(link.observed("power.applied"), torque * rate, 1e-9);
}

// v = F / (m w) (sin w t, 1 - cos w t) for a force that turns with the body at w.
TEST(AppliedForces, AForceThatTurnsWithTheBodyLeadsInACircle) {
  const double w = 3, t = 2, reach = 4.0 / (2 * w);
  for (const std::string& scene :
       {body3(R"("force": [4, 0, 0], "force_frame": "body", "angular_velocity": [0, 0, 3])"),
        body2(R"("force": [4, 0, 0], "force_frame": "body", "angular_velocity": 3)")}) {
    Trial run(scene);
    run.steps(200);
    // Second order: w^2 h^2 / 24 of the speed.
    EXPECT_NEAR(run.field("velocity", 0), reach * std::sin(w * t), 1e-4);
    EXPECT_NEAR(run.field("velocity", 1), reach * (1 - std::cos(w * t)), 1e-4);
    const double along =
        4 * (std::cos(w * t) * std::sin(w * t) + std::sin(w * t) * (1 - std::cos(w * t))) * reach;
    EXPECT_NEAR(run.observed("power.applied"), along, 2e-3);
  }
}

TEST(AppliedForces, OnAFloorWithoutFrictionABodySlides) {
  for (const char* precision : {"f32", "f64"}) {
    const std::string floor = R"(, {"type": "plane", "motion": "fixed", "friction": 0}], "precision": ")" +
                              std::string(precision) + R"(", "gravity": [0, -9.81, 0], "substeps": 5)";
    std::string scene =
        body3(R"("position": [0, 0.5, 0], "friction": 0, "force": [3, 0, 0], "torque": [0, 0.6, 0],
                                 "inertia": [1.2, 1.5, 1.2])",
              floor);
    scene.erase(scene.rfind("]}"), 1);
    Trial run(scene);
    run.steps(200);
    EXPECT_NEAR(run.field("velocity", 0), 3, 3e-3) << precision;
    EXPECT_NEAR(run.field("angular_velocity", 1), 0.8, 3e-3) << precision;
    EXPECT_EQ(run.observed("awake"), 1) << precision;
  }
}

// A pendulum under a constant force is one in gravity: force m g downwards on the centre of mass.
TEST(AppliedForces, AForceOnALinkIsItsWeight) {
  const std::string link =
      R"("axis": [0, 0, 1], "mass": 2, "center": [0.5, 0, 0], "inertia": [0.1, 0.2, 0.2])";
  Trial pushed(R"({"type": "articulation", "id": "r", "links": [{)" + link +
               R"(, "force": [0, -19.62, 0]}]})");
  Trial heavy(R"({"type": "articulation", "id": "r", "gravity": [0, -9.81, 0], "links": [{)" + link + "}]}");
  const double before = pushed.observed("energy.total");
  pushed.steps(300), heavy.steps(300);
  EXPECT_NEAR(pushed.field("angular_velocity", 2), heavy.field("angular_velocity", 2), 1e-12);
  EXPECT_NEAR(pushed.observed("energy.total"), before, 1e-5);
  EXPECT_NEAR(pushed.observed("energy.potential"), heavy.observed("energy.potential"), 1e-10);
  // The control: a force that turns with the link pushes it round and round.
  Trial round(R"({"type": "articulation", "id": "r", "links": [{)" + link +
              R"(, "force": [0, -19.62, 0], "force_frame": "link"}]})");
  round.steps(300);
  EXPECT_NEAR(round.field("angular_velocity", 2), -19.62 * 0.5 / (0.2 + 2 * 0.25) * 3, 1e-6);
}

}  // namespace
}  // namespace truestep
