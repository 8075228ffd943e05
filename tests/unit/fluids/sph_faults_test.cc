// What a scene must not contain about a liquid, where the error is reported, and the effects of commands on
// particles.
#include "engine/base/errors.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using Faults = std::vector<std::string>;
using testing_rig::SphRun;

Faults faults(const SphDef& d) {
  Faults out;
  sph_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

SphDef piece(int dimension = 2) {
  SphDef d;
  d.dimension = dimension;
  d.bodies = {{.center = {0.5, 0.5, 0.5}}};
  return d;
}

TEST(SphScene, SaysWhatDoesNotFit) {
  EXPECT_EQ(faults(piece(2)), Faults{});
  EXPECT_EQ(faults(piece(3)), Faults{});
  SphDef d = piece();
  d.bodies[0].center.x = 0.95;
  EXPECT_EQ(faults(d), Faults{"/bodies/0"}) << "reaches out of the box";
  d = piece();
  d.high = d.low;
  EXPECT_EQ(faults(d), Faults{"/high"});
  d = piece(3);
  d.spacing = 1e-5;
  EXPECT_EQ(faults(d), Faults{"/spacing"}) << "1e14 cells";
  d = piece(3);
  d.bodies[0].half_extents = {0.5, 0.5, 0.5}, d.spacing = 0.003;
  EXPECT_EQ(faults(d), Faults{"/bodies"}) << "4e7 particles";
  d = piece();
  d.bodies[0].velocity.z = 1;
  EXPECT_EQ(faults(d), Faults{"/bodies/0/velocity"}) << "out of the plane";
  d = piece();
  d.periodic = Periodic::z;
  EXPECT_EQ(faults(d), Faults{"/periodic"});
  d = piece();
  d.lid_velocity.y = 1;
  EXPECT_EQ(faults(d), Faults{"/lid_velocity"});
  d = piece();
  d.periodic = Periodic::xy;
  EXPECT_EQ(faults(d), Faults{});
  d.lid_velocity.x = 1;
  EXPECT_EQ(faults(d), Faults{"/lid_velocity"}) << "no upper side";
  d = piece();
  d.initial = {"y", "0"};
  EXPECT_EQ(faults(d), Faults{});
  d.initial.push_back("0");
  EXPECT_EQ(faults(d), Faults{"/initial"}) << "a third component in the plane";
  d = piece();
  d.bodies.clear();
  EXPECT_EQ(faults(d), Faults{"/bodies"}) << "nothing at all";
  d = piece();
  d.bodies[0].density = 2e6;
  EXPECT_EQ(faults(d), Faults{"/bodies/0/density"}) << "2000 times the system's";
  d = piece();
  d.kernel = Smoothing::poly6_spiky;
  EXPECT_EQ(faults(d), Faults{});
  d.support = 2.5;
  EXPECT_EQ(faults(d), Faults{"/support"}) << "with dfsph";
  d.solver = Method::wcsph;
  EXPECT_EQ(faults(d), Faults{});
  d = piece();
  d.max_particles = 3;
  EXPECT_EQ(faults(d), Faults{"/max_particles"});
  InletDef nozzle;
  nozzle.position = {0.5, 0.5, 0};
  d = piece();
  d.emitters = {nozzle};
  EXPECT_EQ(faults(d), Faults{});
  d.emitters[0].position.y = 0.03;
  EXPECT_EQ(faults(d), Faults{"/emitters/0/position"}) << "its back is below the floor";
  d.emitters = {nozzle}, d.emitters[0].radius = 0.001;
  EXPECT_EQ(faults(d), Faults{"/emitters/0/radius"}) << "no particle";
  d.emitters = {nozzle}, d.emitters[0].radius = 1e9;
  EXPECT_EQ(faults(d), Faults{"/emitters/0/radius"}) << "too many";
  d.emitters = {nozzle}, d.emitters[0].direction = {0, 0, 1};
  EXPECT_EQ(faults(d), Faults{"/emitters/0/direction"}) << "out of the plane";
}

TEST(SphScene, SaysWhichInitialVelocityIsNone) {
  const auto fault = [](const std::string& text) -> std::string {
    SphDef d = piece();
    d.initial = {"0", text};
    try {
      const SphRun run(d);
    } catch (const Error& e) {
      return e.issues().at(0).pointer;
    }
    return "";
  };
  EXPECT_EQ(fault("sin(x"), "/initial/1") << "it does not end";
  EXPECT_EQ(fault("z"), "/initial/1") << "no such axis in the plane";
  EXPECT_EQ(fault("1 / (x - x)"), "/initial") << "not finite";
  EXPECT_EQ(fault("sin(x)"), "") << "control";
}

TEST(SphScene, ExpectsAsManyParticlesAsThereAre) {
  for (const int dimension : {2, 3}) {
    SphDef d = piece(dimension);
    EXPECT_EQ(expected_particles(d), static_cast<double>(places_of(d, d.bodies[0]).size()));
    d.bodies[0].shape = Shape::ball, d.bodies[0].radius = 0.3;
    const auto n = static_cast<double>(places_of(d, d.bodies[0]).size());
    // The lattice of a ball has the ball's volume except near its surface.
    EXPECT_NEAR(expected_particles(d), n, 0.05 * n);
  }
}

// Faster than the allowed number of substeps: refused with a step that works, and that step works.
TEST(SphLimits, RefuseAStepThatIsTooLongAndSayWhichIsNot) {
  SphDef d = piece();
  d.solver = Method::wcsph, d.max_substeps = 20;
  SphRun run(d, 1, {0, -9.81, 0});
  double allowed = 0;
  try {
    run.step();
    FAIL() << "a second of sound waves in 20 substeps";
  } catch (const Instability& e) {
    allowed = e.suggested_dt;
  }
  EXPECT_GT(allowed, 0);
  EXPECT_LT(allowed, 0.1);
  SphRun good(d, 0.9 * allowed, {0, -9.81, 0});
  EXPECT_NO_THROW(good.step());
}

TEST(SphCommands, ImpulsesMoveParticlesAndGravityIsSet) {
  SphRun run(piece(), 0.01);
  Command push{.kind = CommandKind::impulse};
  push.index = 3, push.vector = {2 * run.system.setting().mass, 0, 0};
  run.system.apply(run.state, push);
  EXPECT_EQ(run.velocity(3).x, 2);
  EXPECT_EQ(run.velocity(2).x, 0) << "control: the particle beside it";
  push.vector = {0, 0, 1};
  EXPECT_THROW(run.system.apply(run.state, push), Error) << "out of the plane";
  Command gravity{.kind = CommandKind::set_parameter, .name = "gravity"};
  gravity.vector = {0, -1, 0};
  run.system.apply(run.state, gravity);
  SphRun other(piece(), 0.01, {0, -1, 0});
  push.vector = {2 * run.system.setting().mass, 0, 0};
  other.system.apply(other.state, push);
  run.step(), other.step();
  EXPECT_EQ(run.state.hash(), other.state.hash());
}

}  // namespace
}  // namespace truestep::sph
