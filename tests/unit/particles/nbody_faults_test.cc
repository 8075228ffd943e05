// What a scene of bodies must not contain, what commands must not do, and collisions.
#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"
#include "tests/support/nbody_run.h"

namespace truestep::nbody {
namespace {

using testing_rig::model_units;
using testing_rig::NbodyRun;
using Faults = std::vector<std::string>;

Faults faults(const NbodyDef& d) {
  Faults out;
  nbody_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

NbodyDef two(const Vec3& v) {
  NbodyDef d = model_units();
  d.positions = {{-1, 0, 0}, {1, 0, 0}}, d.velocities = {v, -v};
  d.gravitational_constant = 0, d.masses = {1, 3}, d.radius = 0.1;
  d.integrator = "leapfrog";
  return d;
}

TEST(NbodyScene, SaysWhatDoesNotFit) {
  EXPECT_EQ(faults(two({})), Faults{});
  NbodyDef d = model_units();
  EXPECT_EQ(faults(d), Faults{""}) << "nobody is there";
  d = two({});
  d.velocities.pop_back(), d.masses.pop_back(), d.radii = {1};
  EXPECT_EQ(faults(d), (Faults{"/velocities", "/masses", "/radii"}));
  d = two({});
  d.groups = {OrbitDef{.around = 2}, RingDef{.around = 2}};
  EXPECT_EQ(faults(d), Faults{"/groups/0/around"}) << "the second one may stand around the first";
  d.groups = {PlummerDef{.count = 3'000'000}, SphereDef{.count = 3'000'000}};
  EXPECT_EQ(faults(d), Faults{"/groups"});
}

/// Faults of a scene of one body: "pointer message; allowed".
std::vector<std::string> scene_faults(const std::string& members) {
  try {
    const World world(
        parse_scene(R"({"systems": [{"type": "nbody", "positions": [[0, 0, 0]], )" + members + "}]}"));
  } catch (const Error& e) {
    std::vector<std::string> out;
    for (const Issue& i : e.issues())
      out.push_back(i.pointer + ' ' + i.message + "; " + i.allowed + i.did_you_mean);
    return out;
  }
  return {};
}

TEST(NbodyScene, MethodsOfBodiesAloneAreKnownByName) {
  // Beside another error they are not reported separately.
  const auto other = scene_faults(R"("mass": -1, "integrator": "leapfrog")");
  ASSERT_EQ(other.size(), 1u);
  for (const char* own : {"wisdom_holman", "mercurius", "hermite"}) {
    EXPECT_EQ(scene_faults(R"("mass": -1, "integrator": ")" + std::string(own) + '"'), other) << own;
  }
  // A wrong name is reported with the valid ones, once.
  const auto wrong = scene_faults(R"("integrator": "mercuriu")");
  ASSERT_EQ(wrong.size(), 1u);
  for (const char* own : {"wisdom_holman", "mercurius", "hermite", "ias15"}) {
    EXPECT_NE(wrong[0].find(own), std::string::npos) << wrong[0];
  }
}

TEST(NbodyScene, WisdomAndHolmanNeedASun) {
  NbodyDef d = two({});
  d.integrator = "wisdom_holman";
  EXPECT_THROW(NbodyRun(d, 0.1), Error);
  d.integrator = "hermite", d.softening = 0.1;
  EXPECT_NO_THROW(NbodyRun(d, 0.1));
  d.softening_kind = gravity::SofteningKind::spline;
  EXPECT_THROW(NbodyRun(d, 0.1), Error);
  d.integrator = "mercurius";
  EXPECT_THROW(NbodyRun(d, 0.1), Error);
  d.softening_kind = gravity::SofteningKind::plummer;
  EXPECT_THROW(NbodyRun(d, 0.1), Error) << "two alike";
  for (const char* method : {"wisdom_holman", "mercurius"}) {
    d.integrator = method, d.masses = {31, 3};
    NbodyRun run(d, 0.1);
    run.step(3);
    EXPECT_FALSE(run.state.first_bad());
  }
  d.collisions = CollisionsDef{};
  EXPECT_THROW(NbodyRun(d, 0.1), Error) << "mercurius steps over them";
}

std::string refused(NbodyRun& run, const Command& c) {
  try {
    run.system->apply(run.state, c);
  } catch (const Error& e) {
    return e.issues().at(0).pointer;
  }
  return "";
}

TEST(NbodyCommands, PushHitDragAndWhatIsRefused) {
  NbodyDef d = two({});
  d.masses = {1, 0};
  NbodyRun run(d, 0.1);
  EXPECT_EQ(refused(run, {.kind = CommandKind::impulse, .index = 0, .vector = {2, 0, 0}}), "");
  EXPECT_EQ(run.v(0), (Vec3{2, 0, 0}));
  EXPECT_EQ(refused(run, {.kind = CommandKind::push, .index = 0, .vector = {0, 5, 0}, .duration = 0.2}), "");
  run.step(4);
  EXPECT_NEAR(run.v(0).y, 1, 1e-12) << "5 N for 0.2 s on 1 kg";
  EXPECT_EQ(refused(run, {.kind = CommandKind::drag, .index = 0, .vector = {9, 0, 0}, .value = 4}), "");
  run.step(200);
  EXPECT_NEAR(run.x(0).x, 9, 1e-3);
  EXPECT_EQ(refused(run, {.kind = CommandKind::impulse, .index = 1}), "/index") << "it has no mass";
  EXPECT_EQ(refused(run, {.kind = CommandKind::impulse, .index = 2}), "/index");
  EXPECT_EQ(refused(run, {.kind = CommandKind::drag, .index = 0}), "/value");
  EXPECT_EQ(refused(run, {.kind = CommandKind::pin, .index = 0}), "/type");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = 1, .name = "gravity"}), "/name");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = -1, .name = "softening"}), "/value");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = 2, .name = "gravitational_constant"}),
            "");
  EXPECT_EQ(parameter(run.state, Parameter::gravitational_constant), 2);
}

TEST(NbodyCommands, HermitesSchemeTakesNoOtherForces) {
  NbodyDef d = two({});
  d.integrator = "hermite";
  NbodyRun run(d, 0.1);
  EXPECT_EQ(refused(run, {.kind = CommandKind::push, .index = 0, .vector = {0, 5, 0}, .duration = 1}),
            "/type");
  EXPECT_EQ(refused(run, {.kind = CommandKind::drag, .index = 0, .vector = {9, 0, 0}, .value = 4}), "/type");
  EXPECT_EQ(refused(run, {.kind = CommandKind::impulse, .index = 0, .vector = {2, 0, 0}}), "") << "control";
}

TEST(NbodyCollisions, MergeBounceAndStopKeepMomentum) {
  // They touch at t = 0.9 between steps of 0.25: 1 kg and 3 kg at 1 m/s each towards the other.
  for (const Response response : {Response::merge, Response::bounce, Response::stop}) {
    NbodyDef d = two({1, 0, 0});
    d.collisions = CollisionsDef{response, 0.5};
    NbodyRun run(d, 0.25);
    const Vec3 before = run.observe3("momentum"), middle = run.observe3("center");
    run.step(8);
    EXPECT_LT(norm(run.observe3("momentum") - before), 1e-14);
    EXPECT_LT(norm(run.observe3("center") - middle - before * (2.0 / 4)), 1e-14);
    EXPECT_EQ(run.observe("collisions"), 1);
    if (response == Response::merge) {
      ASSERT_EQ(run.count(), 1u);
      EXPECT_EQ(run.state.f64(Columns::mass)[0], 4);
      EXPECT_NEAR(std::pow(run.state.f64(Columns::radius)[0], 3), 2e-3, 1e-15) << "both volumes";
      EXPECT_EQ(run.state.span<uint64_t>(Columns::id)[0], 1u) << "the heavier one's";
    } else {
      // Restitution: of the relative speed of 2 m/s, 1 m/s is left, or none. Their distance is what that
      // gives after the touch.
      const double apart = response == Response::bounce ? 1 : 0;
      EXPECT_NEAR(run.v(1).x - run.v(0).x, apart, 1e-14);
      EXPECT_NEAR(run.x(1).x - run.x(0).x, 0.2 + apart * (2 - 0.9), 1e-13);
    }
  }
  // Control: without them they pass through each other.
  NbodyRun through(two({1, 0, 0}), 0.25);
  through.step(8);
  EXPECT_LT(through.x(1).x, through.x(0).x);
}

TEST(NbodyCollisions, ManyMergeIntoOneAndTheRunGoesOn) {
  NbodyDef d = model_units();
  d.groups = {SphereDef{.count = 600}};
  d.radius = 0.03, d.softening = 0.02, d.collisions = CollisionsDef{};
  for (const char* method : {"leapfrog", "ias15", "rk4"}) {
    d.integrator = method;
    NbodyRun run(d, 0.02);
    const Vec3 l = run.observe3("angular_momentum");
    run.step(80);
    EXPECT_LT(run.count(), 300u) << method;
    EXPECT_EQ(static_cast<double>(run.count()) + run.observe("collisions"), 600) << method;
    EXPECT_LT(norm(run.observe3("momentum")), 1e-12) << method;
    double mass = 0;
    for (const double m : run.state.f64(Columns::mass)) mass += m;
    EXPECT_NEAR(mass, 1, 1e-13) << method;
    EXPECT_FALSE(run.state.first_bad()) << method;
    EXPECT_LT(norm(l), 1e-14);
  }
}

TEST(NbodyStability, CoincidentMasslessAndLonelyBodies) {
  NbodyDef d = model_units();
  d.masses = {1, 1, 0, 1};
  for (const Method method : {Method::direct, Method::tree}) {
    // One has escaped: as far as squares and cubes of distances are finite, or as far as the tree can resolve
    // the others.
    d.positions = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {method == Method::direct ? 1e100 : 1e12, 0, 0}};
    d.method = method, d.integrator = "leapfrog";
    NbodyRun run(d, 0.01);
    run.step(10);
    EXPECT_FALSE(run.state.first_bad());
    EXPECT_LT(norm(run.x(0)), 1e-20);
    EXPECT_LT(run.x(2).x, 1) << "two bodies of mass 1 attract it";
  }
  d.masses = {0, 0, 0, 0};
  NbodyRun nobody(d, 0.01);
  nobody.step(10);
  EXPECT_EQ(nobody.x(2), (Vec3{1, 0, 0}));
  EXPECT_FALSE(nobody.state.first_bad());
}

TEST(NbodyGroups, AnOrbitHasItsElementsAndARingItsSpeed) {
  NbodyDef d = model_units();
  d.positions = {{1, 2, 3}}, d.velocities = {{0.1, 0, 0}}, d.mass = 2;
  d.groups = {OrbitDef{.mass = 1,
                       .semi_major_axis = 4,
                       .eccentricity = 0.6,
                       .inclination = 0.5,
                       .ascending_node = 1,
                       .periapsis = 2,
                       .mean_anomaly = 0.7},
              RingDef{.count = 10, .inner_radius = 5, .outer_radius = 5, .axis = {0, 3, 0}}};
  NbodyRun run(d, 0.01);
  const Vec3 r = run.x(1) - run.x(0), v = run.v(1) - run.v(0), h = cross(r, v);
  EXPECT_NEAR(0.5 * norm2(v) - 3 / norm(r), -3 / 8.0, 1e-14) << "energy -mu/2a";
  EXPECT_NEAR(norm2(h), 3 * 4 * (1 - 0.36), 1e-13);
  EXPECT_NEAR(h.z / norm(h), std::cos(0.5), 1e-14);
  EXPECT_NEAR(std::atan2(h.x, -h.y), 1, 1e-14) << "the node's longitude";
  const Vec3 e = cross(v, h) / 3 - r / norm(r);
  EXPECT_NEAR(norm(e), 0.6, 1e-14);
  EXPECT_NEAR(e.z / norm(e), std::sin(2.0) * std::sin(0.5), 1e-13);
  for (size_t i = 2; i < 12; ++i) {
    const Vec3 at = run.x(i) - run.x(0), u = run.v(i) - run.v(0);
    EXPECT_NEAR(norm(at), 5, 1e-13);
    EXPECT_NEAR(norm2(u), 2 / 5.0, 1e-14);
    EXPECT_NEAR(dot(cross(at, u), Vec3{0, 1, 0}), 5 * norm(u), 1e-13);
  }
}

}  // namespace
}  // namespace truestep::nbody
