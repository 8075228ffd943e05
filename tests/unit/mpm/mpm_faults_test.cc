// What a scene must not contain about pieces of material, and where the error is reported.
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using Faults = std::vector<std::string>;

Faults faults(const MpmDef& d) {
  Faults out;
  mpm_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

MpmDef piece(int dimension = 2) {
  MpmDef d;
  d.dimension = dimension;
  d.bodies = {{.center = {0.5, 0.5, 0.5}}};
  return d;
}

TEST(MpmScene, TakesWhatIsRight) {
  EXPECT_EQ(faults(piece(2)), Faults{});
  EXPECT_EQ(faults(piece(3)), Faults{});
}

TEST(MpmScene, SaysWhatDoesNotFit) {
  MpmDef d = piece();
  d.bodies[0].center.x = 0.95;
  EXPECT_EQ(faults(d), Faults{"/bodies/0"}) << "reaches out of the box";
  d = piece();
  d.high = d.low;
  EXPECT_EQ(faults(d), Faults{"/high"});
  d = piece();
  d.cell = 1e-6;
  EXPECT_EQ(faults(d), Faults{"/cell"}) << "1e12 cells";
  d = piece();
  d.bodies[0].velocity.z = 1;
  EXPECT_EQ(faults(d), Faults{"/bodies/0/velocity"}) << "out of the plane";
  d = piece();
  d.bodies[0].spin.x = 1;
  EXPECT_EQ(faults(d), Faults{"/bodies/0/spin"}) << "out of the plane";
  d = piece(3);
  d.bodies[0].velocity.z = 1, d.bodies[0].spin.x = 1;
  EXPECT_EQ(faults(d), Faults{}) << "control: both are right in space";
}

TEST(MpmScene, TheImplicitStepTakesStiffSolidsInDoublesAlone) {
  MpmDef d = piece();
  d.integration = Integration::implicit_steps;
  EXPECT_EQ(faults(d), Faults{"/precision"});
  d.precision = Precision::f64;
  EXPECT_EQ(faults(d), Faults{}) << "control";
  for (const Law law : {Law::fluid, Law::snow, Law::sand, Law::foam}) {
    d.bodies[0].material = law;
    EXPECT_EQ(faults(d), Faults{"/bodies/0/material"});
  }
  d.bodies[0].material = Law::corotated, d.bodies.push_back(d.bodies[0]), d.bodies[1].velocity_field = 3;
  EXPECT_EQ(faults(d), Faults{"/bodies/1/velocity_field"}) << "several fields are explicit";
  d.bodies[0].velocity_field = 3;
  EXPECT_EQ(faults(d), Faults{}) << "control: one field, whatever its number";
  EXPECT_FALSE(testing_rig::MpmRun(piece()).system.ports().medium == std::nullopt);
  d = piece(), d.integration = Integration::implicit_steps, d.precision = Precision::f64;
  EXPECT_TRUE(testing_rig::MpmRun(d).system.ports().medium == std::nullopt) << "no bodies in it";
}

TEST(MpmScene, SaysWhatDoesNotFitOfTexts) {
  MpmDef d = piece();
  d.force = {"x"};
  EXPECT_EQ(faults(d), Faults{"/force"}) << "one component of two";
  d.force = {"-x", "t"}, d.exact = {"x", "y", "z"};
  EXPECT_EQ(faults(d), Faults{"/exact"}) << "three of two";
  d.exact = {"x", "y + t"};
  EXPECT_EQ(faults(d), Faults{}) << "control";
  d.force[1] = "z";
  try {
    testing_rig::MpmRun run(d);
    ADD_FAILURE() << "there is no z in the plane";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/force/1");
  }
  d = piece();
  d.bodies[0].shape = Shape::ball, d.bodies[0].inner_radius = 0.1;
  EXPECT_EQ(faults(d), Faults{"/bodies/0/inner_radius"}) << "as large as the ball";
  d.bodies[0].inner_radius = 0.05;
  EXPECT_EQ(faults(d), Faults{}) << "control";
}

// A thread has almost no volume and one particle per axis across: a lattice of 4e7 places along it.
TEST(MpmScene, CountsWhatAThreadWouldBeMadeOf) {
  MpmDef d = piece();
  d.low = {0, 0, 0}, d.high = {2.4e7, 4, 1}, d.cell = 1;
  d.bodies[0].center = {1.2e7, 2, 0}, d.bodies[0].half_extents = {1e7, 1e-9, 0.5};
  EXPECT_GT(expected_particles(d), 3e7);
  EXPECT_EQ(faults(d), Faults{"/bodies"});
  d.bodies[0].half_extents.x = 1e3;
  EXPECT_EQ(faults(d), Faults{}) << "control: a short one";
  EXPECT_EQ(places_of(d, d.bodies[0]).size(), 4000u);
}

TEST(MpmScene, ExpectsAsManyParticlesAsThereAre) {
  for (const int dimension : {2, 3}) {
    MpmDef d = piece(dimension);
    const auto there = [&] { return static_cast<double>(places_of(d, d.bodies[0]).size()); };
    EXPECT_EQ(expected_particles(d), there());
    d.bodies[0].shape = Shape::ball, d.bodies[0].radius = 0.3;
    // The number of lattice places within a ball of 38 spacings differs from its volume by less than a shell
    // a tenth of a spacing thick.
    EXPECT_NEAR(expected_particles(d), there(), 0.1 / 38 * 3 * there());
    d.bodies[0].inner_radius = 0.2;
    EXPECT_NEAR(expected_particles(d), there(), 0.1 / 26 * 3 * there()) << "hollow";
  }
}

// Waves of 1e5 m/s cross 1.6e5 cells of 1/64 m in a sixtieth of a second.
TEST(MpmScene, AStepOfTooManySubstepsIsRefused) {
  MpmDef d = piece();
  d.bodies[0].youngs_modulus = 1e13;
  testing_rig::MpmRun run(d);
  EXPECT_THROW(run.step(), Error);
  d.max_substeps = 1'000'000, d.bodies[0].youngs_modulus = 1e7;
  testing_rig::MpmRun soft(d);
  EXPECT_NO_THROW(soft.step()) << "control";
}

}  // namespace
}  // namespace truestep::mpm
