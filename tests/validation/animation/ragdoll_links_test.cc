// A skeleton of a ball, a pin, a slider and another ball hands over to links of an articulation with joints
// of the same kinds: motions that the joints allow continue to rounding, momenta continue in any case, limits
// of pin and slider hold, and every phase restores to the bit. Bones' velocities are means over a step, so
// that three of them in a rotating chain are not quite consistent: by a b^2 h / 2 (a: arm, b: angular
// velocity).
#include <cmath>

#include "engine/core/ports/rig_port.h"
#include "engine/kernels/animation/rotations.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

struct Told {
  std::string coupling;
  std::string turn_a = R"s("0", "0.3*sin(2*t)", "3*t")s", pin = "0.4*sin(3*t)", slide = "0.1*sin(4*t)",
              turn_d = R"s("0.5*sin(5*t)", "0", "0.3*t")s", gravity = "[0, -9.81, 0]", more = "",
              more_couplings = "";
  double dt = 0.005;
};

std::string arm(const Told& t) {
  const auto link = [](const char* id, const char* rest, double mass, double center) {
    const double i = mass * 0.01;
    return R"({"id": ")" + std::string(id) + R"(", )" + rest + R"(, "mass": )" + std::to_string(mass) +
           R"(, "center": [)" + std::to_string(center) + R"(, 0, 0], "inertia": [)" +
           std::to_string(0.2 * i) + ", " + std::to_string(i) + ", " + std::to_string(1.1 * i) + "]}";
  };
  return R"({"gravity": )" + t.gravity + R"(, "time": {"dt": )" + std::to_string(t.dt) + R"(}, "systems": [
    {"type": "skeleton", "id": "arm", "bone_radius": 0.05, "root_position": ["0.8*t", "2 + 0.1*t", "0"], "joints": [
      {"id": "a", "type": "ball", "rotation": [)" +
         t.turn_a + R"(]},
      {"id": "b", "parent": "a", "offset": [0.5, 0, 0], "type": "revolute", "axis": [0, 0, 1], "min": -0.5, "max": 0.5, "value": ")" +
         t.pin + R"("},
      {"id": "c", "parent": "b", "offset": [0.4, 0, 0], "type": "prismatic", "axis": [1, 0, 0], "min": -0.15, "max": 0.15, "value": ")" +
         t.slide + R"("},
      {"id": "d", "parent": "c", "offset": [0.3, 0, 0], "type": "ball", "rotation": [)" +
         t.turn_d + R"(], "end": [0.3, 0, 0]}]},
    {"type": "articulation", "id": "doll", "links": [)" +
         link("a", R"("joint": "free", "offset": [0, 2, 0])", 2, 0.25) + "," +
         link(
             "b",
             R"("joint": "revolute", "axis": [0, 0, 1], "offset": [0.5, 0, 0], "lowest": -0.5, "highest": 0.5)",
             1, 0.2) +
         "," +
         link(
             "c",
             R"("joint": "prismatic", "axis": [1, 0, 0], "offset": [0.4, 0, 0], "lowest": -0.15, "highest": 0.15)",
             0.8, 0.15) +
         "," + link("d", R"("joint": "spherical", "offset": [0.3, 0, 0])", 0.5, 0.15) + R"(]})" + t.more +
         R"(], "couplings": [{"type": "ragdoll", "id": "r", "a": "arm", "b": "doll", )" + t.coupling + "}" +
         t.more_couplings + "]}";
}

constexpr double kMass[] = {2, 1, 0.8, 0.5};

struct Sides {
  explicit Sides(const testing_coupled::SceneRun& run)
      : rig(*rig_of(run.world->system(0))),
        ports(run.world->system(1).ports()),
        bones(run.session.state().systems[0], rig.bones),
        links(run.session.state().systems[1], *ports.bodies) {}
  RigPort rig;
  Ports ports;
  ConstBodies bones, links;

  double apart() const {
    double most = 0;
    for (size_t k = 0; k < 4; ++k) most = std::max(most, norm(bones.place(k) - links.place(k)));
    return most;
  }
  /// Largest difference of velocities and of spins.
  std::pair<double, double> faster() const {
    double v = 0, w = 0;
    for (size_t k = 0; k < 4; ++k) {
      v = std::max(v, norm(bones.velocity(k) - links.velocity(k)));
      w = std::max(w, norm(bones.spin(k) - links.spin(k)));
    }
    return {v, w};
  }
  /// kg m/s and kg m^2/s about the origin, of links of the same masses that move like the bones.
  std::pair<Vec3, Vec3> momenta_of_bones() const {
    Vec3 p, l;
    for (size_t k = 0; k < 4; ++k) {
      const double i = kMass[k] * 0.01;
      p += bones.velocity(k) * kMass[k];
      l += cross(bones.place(k), bones.velocity(k)) * kMass[k] +
           free_rotation::momentum({links.orientation(k), bones.spin(k)}, {0.2 * i, i, 1.1 * i});
    }
    return {p, l};
  }
};

TEST(RagdollLinks, AreCarriedWithTheBonesMomenta) {
  testing_coupled::SceneRun run(arm({.coupling = R"("at": 30)"}));
  double spin = 0;
  for (int k = 0; k < 100; ++k) {
    run.session.step(1);
    const Sides s(run);
    const auto [p, l] = s.momenta_of_bones();
    // Every joint can be where its bone is, and a free root takes the momentum: rounding of sums of some 5 kg
    // m/s and of poses of 2 m.
    ASSERT_LT(s.apart(), 1e-12) << k;
    ASSERT_LT(norm(run.observe3("doll.momentum") - p), 1e-12) << k;
    ASSERT_LT(norm(run.observe3("doll.angular_momentum") - l), 1e-11) << k;
    spin = std::max(spin, norm(l));
    EXPECT_LT(run.observe("r.apart"), 1e-12);
  }
  EXPECT_GT(spin, 3) << "the control: it moves";
}

TEST(RagdollLinks, WhatJointsCanDoGoesOnToRounding) {
  // A translation, a slide at constant speed: means over a step equal the velocities. Bones begin where the
  // links are (a pair keeps its offset at t = 0).
  testing_coupled::SceneRun run(arm({.coupling = R"("at": 30)",
                                     .turn_a = R"("0", "0", "0")",
                                     .pin = "0",
                                     .slide = "0.4*t",
                                     .turn_d = R"("0", "0", "0")"}));
  run.session.step(40);
  const auto [v, w] = Sides(run).faster();
  EXPECT_LT(v, 1e-12);
  EXPECT_LT(w, 1e-12);
  EXPECT_GT(norm(Sides(run).bones.velocity(3) - Sides(run).bones.velocity(0)), 0.3)
      << "the control: it slides";
}

TEST(RagdollLinks, ATurningChainDiffersByTheMeansAlone) {
  // Rotations about one axis: halving the step halves the difference, which is that between chords and
  // tangents.
  double v[2], w[2];
  for (int k = 0; k < 2; ++k) {
    testing_coupled::SceneRun run(arm({.coupling = R"("at": 30)",
                                       .turn_a = R"("0", "0", "3*t")",
                                       .pin = "0.4*sin(t)",
                                       .slide = "0",
                                       .turn_d = R"("0", "0", "t")",
                                       .dt = k == 0 ? 0.005 : 0.0025}));
    run.session.step(k == 0 ? 40 : 80);
    std::tie(v[k], w[k]) = Sides(run).faster();
  }
  // Of a = 1.4 m at 5 rad/s, h = 5 ms: 0.0875 m/s if it took all of it.
  EXPECT_LT(v[0], 0.0875);
  EXPECT_NEAR(v[0] / v[1], 2, 0.1);
  EXPECT_NEAR(w[0] / w[1], 2, 0.1);
}

TEST(RagdollLinks, MomentaGoOnAtTheHandOver) {
  testing_coupled::SceneRun run(arm({.coupling = R"("at": 0.3)"}));
  run.session.step(60);
  const Vec3 p = run.observe3("doll.momentum"), place = [&] {
    const Sides s(run);
    Vec3 sum;
    for (size_t k = 0; k < 4; ++k) sum += s.links.place(k) * kMass[k];
    return sum;
  }();
  const Vec3 l = run.observe3("doll.angular_momentum");
  const double m = 4.3, t = 0.2;
  const Vec3 g{0, -9.81, 0};
  run.session.step(1);
  EXPECT_EQ(run.observe("r.lead"), 1);
  EXPECT_NEAR(run.observe("r.time"), 0.3, 1e-12);
  // The integrator's tolerance is 1e-6 of its coordinates at most (integrator_def.h); momenta of a free root
  // are linear in its velocities.
  EXPECT_LT(norm(run.observe3("doll.momentum") - p - g * (m * 0.005)), 1e-5);
  run.session.step(39);
  // The centre falls on its parabola, the spin changes by the weight's moment about the origin.
  EXPECT_LT(norm(run.observe3("doll.momentum") - p - g * (m * t)), 1e-5);
  const Vec3 moment = cross(place * t + p * (0.5 * t * t), g);
  EXPECT_LT(norm(run.observe3("doll.angular_momentum") - l - moment), 1e-4);
  EXPECT_GT(norm(moment), 1) << "the control";
  // A tree cannot come apart: the skeleton coincides with its links, slider included.
  EXPECT_LT(Sides(run).apart(), 1e-12);
  EXPECT_LT(run.observe("r.apart"), 1e-12);
}

TEST(RagdollLinks, LimitsOfPinAndSliderHoldWhereItFalls) {
  // Released as pin and slider run towards their limits, at 4 rad/s and 0.8 m/s.
  const Told told{.coupling = R"("at": 0.1)",
                  .turn_a = R"("0", "0", "0")",
                  .pin = "4*t",
                  .slide = "0.8*t",
                  .gravity = "[0, 0, 0]"};
  testing_coupled::SceneRun run(arm(told));
  double pin = 0, slide = 0;
  for (int k = 0; k < 200; ++k) {
    run.session.step(1);
    const auto& q = run.session.state().systems[1].f64(0);  // 3 + 4 of the root, pin, slider
    pin = std::max(pin, q[7]), slide = std::max(slide, q[8]);
  }
  // Springs of 1000 N m/rad and N/m hold no more than the available energy: E = k x^2 / 2 at most.
  const double beyond = std::sqrt(2 * run.observe("doll.energy.total") / 1000) + 1e-3;
  EXPECT_GT(pin, 0.5);
  EXPECT_LT(pin, 0.5 + beyond);
  EXPECT_GT(slide, 0.15);
  EXPECT_LT(slide, 0.15 + beyond);
  EXPECT_LT(beyond, 0.2) << "the control: in a second free joints go 4 rad and 0.8 m";
}

TEST(RagdollLinks, ConeAndTwistOfABallHoldWhereItFalls) {
  // Released while it swings at 4 rad/s and twists at 3: a cone of 0.4 rad about x and 0.3 rad of twist.
  std::string scene = arm({.coupling = R"("at": 0.05)",
                           .turn_a = R"("0", "0", "0")",
                           .pin = "0",
                           .slide = "0",
                           .turn_d = R"("3*t", "0", "4*t")",
                           .gravity = "[0, 0, 0]"});
  const std::string ball = R"("joint": "spherical")";
  scene.replace(scene.find(ball), ball.size(),
                ball + R"(, "axis": [1, 0, 0], "cone": 0.4, "lowest": -0.3, "highest": 0.3)");
  testing_coupled::SceneRun run(scene);
  double swing = 0, twist = 0, first = 0;
  for (int k = 0; k < 400; ++k) {
    run.session.step(1);
    const auto q = run.session.state().systems[1].f64(0);  // of the ball after 7 + 1 + 1
    const auto [s, t] = animation::swing_twist({q[9], q[10], q[11], q[12]}, {1, 0, 0});
    swing = std::max(swing, norm(free_rotation::rotation_vector(s))), twist = std::max(twist, std::abs(t));
    if (k == 12) first = run.observe("doll.energy.total");
    // Springs return what they take: 1e-4 of some 3 J, the integrator's tolerance over two seconds.
    if (k > 12) {
      ASSERT_NEAR(run.observe("doll.energy.total"), first, 1e-3) << k;
    }
  }
  const double beyond = std::sqrt(2 * first / 1000) + 1e-3;
  EXPECT_GT(swing, 0.4);
  EXPECT_LT(swing, 0.4 + beyond);
  EXPECT_GT(twist, 0.3);
  EXPECT_LT(twist, 0.3 + beyond);
  EXPECT_LT(beyond, 0.1) << "the control: in two seconds a free ball turns by several rad";
}

TEST(RagdollLinks, AnImpactLetsThemGoWithTheirMomentum) {
  const Told told{
      .coupling = R"("impact": 1)",
      .gravity = "[0, 0, 0]",
      .more =
          R"(, {"type": "particles", "id": "ball", "positions": [[0.55, 3.1, 0.02]], "velocities": [[0.8, -6, 0]], "mass": 3, "radius": 0.1})",
      .more_couplings =
          R"(, {"type": "contact", "id": "hit", "a": "ball", "b": "doll", "restitution": 0.5})"};
  std::string scene = arm(told);
  // An obstacle to hit.
  const std::string center = R"("center": [0.250000, 0, 0])";
  scene.replace(scene.find(center), 0, R"("shapes": [{"type": "capsule", "radius": 0.05, "half_length": 0.25,
      "position": [0.25, 0, 0], "rotation": [0, 0, 1.5707963267948966]}], )");
  testing_coupled::SceneRun run(scene);
  const auto total = [&] { return run.observe3("doll.momentum") + run.observe3("ball.momentum"); };
  Vec3 before, own;
  int steps = 0;
  for (; run.observe("r.lead") == 0 && steps < 200; ++steps) {
    before = total(), own = run.observe3("doll.momentum");
    run.session.step(1);
  }
  ASSERT_LT(steps, 200);
  EXPECT_GT(run.observe("r.impact"), 1);
  EXPECT_GT(norm(run.observe3("doll.momentum") - own), 3) << "the ball gave it momentum";
  // Includes the step's forces: the integrator's tolerance.
  EXPECT_LT(norm(total() - before), 1e-5);
}

TEST(RagdollLinks, EveryPhaseRestoresToTheBitAndItFindsBack) {
  const std::string scene =
      arm({.coupling = R"("at": 0.1, "back_after": 0.2, "blend": 0.3, "match_from": 0, "match_to": 2)"});
  testing_coupled::SceneRun run(scene);
  for (const uint64_t phase : {10, 40, 80}) {
    run.session.step(phase - run.session.step_index());
    testing_coupled::SceneRun other(scene);
    other.session.restore(run.session.state());
    EXPECT_EQ(run.observe("r.lead"), phase == 10 ? 0 : phase == 40 ? 1 : 2);
    testing_coupled::SceneRun straight(scene);
    straight.session.step(phase + 25);
    other.session.step(25);
    EXPECT_EQ(straight.session.state().hash(), other.session.state().hash()) << phase;
  }
  run.session.step(120);
  EXPECT_NEAR(run.observe("arm.joint.a.y"), 2 + 0.1 * (1.0 + 0), 0.5) << "back on its own way";
  EXPECT_LT(Sides(run).apart(), 1e-12) << "and it carries its links again";
}

}  // namespace
}  // namespace truestep
