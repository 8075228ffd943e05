// Steps of particles, whose neighbours come and go, allocate in the first steps only.
#include <gtest/gtest.h>

#include "engine/core/ports/medium.h"
#include "engine/geometry/solid.h"
#include "tests/determinism/allocations/allocation_count.h"
#include "tests/support/runs/nbody_run.h"
#include "tests/unit/fluids/sph_rig.h"
#include "tests/unit/mpm/mpm_rig.h"
#include "tests/unit/particles/crowd_rig.h"
#include "tests/unit/particles/molecular_rig.h"

namespace truestep {
namespace {

TEST(Allocation, AtomsAllocateNothingAfterTheFirstStep) {
  using Method = molecular::ThermostatDef::Method;
  for (const Method method : {Method::velocity_rescaling, Method::langevin, Method::nose_hoover}) {
    molecular::MolecularDef d = testing_rig::liquid(6);
    d.thermostat = molecular::ThermostatDef{method, 1.4, 0.1, 3};
    d.barostat = molecular::BarostatDef{5, 1, 0.1, 10};
    testing_rig::AtomRun run(d, 0.005);
    run.step();
    // Within these steps the crystal melts and the neighbour list is rebuilt many times.
    EXPECT_EQ(test::allocations_of([&] { run.step(100); }), 0u) << static_cast<int>(method);
  }
}

// Neighbours come and go: lists may grow while a column falls, but not once it is at rest.
TEST(Allocation, LiquidsAtRestAndBodiesInThemAllocateNothing) {
  for (const sph::Method solver : {sph::Method::dfsph, sph::Method::wcsph, sph::Method::pbf}) {
    sph::SphDef d;
    d.solver = solver, d.spacing = 0.05, d.viscosity = 1e-3;
    d.bodies = {{.center = {0.5, 0.2, 0.5}, .half_extents = {0.5, 0.2, 0.5}}};
    d.hollows = {{.shape = sph::Shape::ball, .center = {0.5, 0.4, 0.5}, .radius = 0.15}};
    testing_rig::SphRun run(d, 1.0 / 120, {0, -9.81, 0});
    const Solid ball = sphere_solid(0.15);
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 7, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 7 * 0.0225);
    bodies[0].place = {0.5, 0.4, 0.5};
    run.step(20, bodies);
    EXPECT_EQ(test::allocations_of([&] { run.step(10, bodies); }), 0u) << static_cast<int>(solver);
    EXPECT_NE(bodies[0].impulse.y, 0) << "control: the ball is in the water";
  }
}

// A block that breaks apart, with a ball in it: more blocks of cells are in use than at the start.
TEST(Allocation, StepsOfMaterialAllocateNothingAfterTheFirst) {
  const Solid ball = sphere_solid(0.1);
  for (const mpm::Transfer transfer : {mpm::Transfer::apic, mpm::Transfer::flip}) {
    mpm::MpmDef d;
    d.dimension = 3, d.cell = 0.05, d.transfer = transfer;
    mpm::BodyDef piece;
    piece.center = {0.3, 0.3, 0.5}, piece.half_extents = {0.2, 0.3, 0.3}, piece.velocity = {3, 0, 0};
    piece.material = mpm::Law::sand;
    d.bodies = {piece};
    d.bodies.push_back({{.material = mpm::Law::fluid}, mpm::Shape::box, {0.8, 0.1, 0.5}, {0.1, 0.1, 0.3}});
    testing_rig::MpmRun run(d, 1.0 / 120, {0, -9.81, 0});
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 7, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 7 * 0.01);
    bodies[0].place = {0.4, 0.55, 0.5};
    run.step(1, bodies);
    const double width = run.observe("high.x");
    EXPECT_EQ(test::allocations_of([&] { run.step(20, bodies); }), 0u) << static_cast<int>(transfer);
    EXPECT_GT(run.observe("high.x"), std::min(0.95, width)) << "control: it moves";
    EXPECT_NE(bodies[0].impulse.x, 0) << "control: the ball is in the sand";
  }
}

// Contact that begins long after the first step, and the implicit step's solves.
TEST(Allocation, FieldsThatMeetAndImplicitStepsAllocateNothingAfterTheFirst) {
  for (const bool implicit : {false, true}) {
    mpm::MpmDef d;
    d.precision = mpm::Precision::f64, d.cell = 1.0 / 32;
    mpm::BodyDef piece;
    piece.center = {0.3, 0.12, 0}, piece.half_extents = {0.1, 0.1, 1}, piece.youngs_modulus = 1e6;
    d.bodies = {piece, piece};
    d.bodies[1].center.x = 0.7, d.bodies[1].velocity.x = -2;
    if (implicit) d.integration = mpm::Integration::implicit_steps;
    if (!implicit) d.bodies[1].velocity_field = 1;
    testing_rig::MpmRun run(d, 1.0 / 120, {0, -9.81, 0});
    run.step();
    EXPECT_EQ(test::allocations_of([&] { run.step(20); }), 0u) << implicit;
    EXPECT_LT(run.velocity(0).x, -0.05) << "control: they have met";
  }
}

TEST(Allocation, StepsOfBodiesAllocateNothingAfterTheFirst) {
  using nbody::Method;
  for (const Method method : {Method::direct, Method::tree, Method::fmm}) {
    nbody::NbodyDef d = testing_rig::model_units();
    d.groups = {nbody::PlummerDef{.count = 2000}};
    d.softening = 0.05, d.radius = 1e-3, d.method = method;
    d.collisions = nbody::CollisionsDef{nbody::Response::bounce, 0.5};
    testing_rig::NbodyRun run(d, 0.02);
    run.step(3);
    EXPECT_EQ(test::allocations_of([&] { run.step(10); }), 0u) << static_cast<int>(method);
  }
}

TEST(Allocation, CrowdsThatLeaveAllocateNothingAfterTheFirstStep) {
  for (const crowd::Model model : {crowd::Model::social_force, crowd::Model::orca}) {
    crowd::CrowdDef d;
    d.model = model, d.noise = 0.1, d.walls = {{{{-5, -5, 0}, {0, -5, 0}, {0, 5, 0}, {-5, 5, 0}}, true}};
    d.doors = {{"exit", {0, 1, 0}, {0, -1, 0}}};
    d.groups.resize(1);
    crowd::GroupDef& g = d.groups[0];
    g.count = 60, g.center = {-2.5, 0, 0}, g.half_extents = {2.2, 4.5, 0}, g.radius = 0.2;
    g.goal = {3, 0, 0}, g.leave = true;
    testing_rig::CrowdRun run(d);
    run.step();
    EXPECT_EQ(test::allocations_of([&] { run.step(360); }), 0u) << static_cast<int>(model);
    EXPECT_LT(run.people(), 60u);
  }
}

}  // namespace
}  // namespace truestep
