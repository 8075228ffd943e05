// A liquid of particles gives the same bits on any number of threads, with and without a workspace, and from
// a copy of a state.
#include <gtest/gtest.h>

#include "tests/unit/fluids/mesh_collider_rig.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

SphDef column(int dimension, Method solver, Precision precision) {
  SphDef d;
  d.dimension = dimension, d.precision = precision, d.solver = solver;
  d.spacing = dimension == 2 ? 0.02 : 0.05, d.viscosity = 1e-3, d.vorticity = 0.5;
  d.surface_tension = 1, d.surface_tension_model = Tension::interface;
  d.bodies = {{.center = {0.25, 0.4, 0.5}, .half_extents = {0.25, 0.4, 0.5}, .velocity = {1, 0, 0}}};
  return d;
}

TEST(SphDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    for (const int dimension : {2, 3}) {
      for (const Precision precision : {Precision::f32, Precision::f64}) {
        const SphDef d = column(dimension, solver, precision);
        SphRun one(d, 0.01, {0, -9.81, 0}, 1), two(d, 0.01, {0, -9.81, 0}, 2);
        one.step(3), two.step(3);
        EXPECT_EQ(one.state.hash(), two.state.hash());
        SphRun other(d, 0.01, {0, -9.8, 0}, 1);
        other.step(3);
        EXPECT_NE(one.state.hash(), other.state.hash());
      }
    }
  }
}

TEST(SphDeterminism, AStateIsAllThatAStepNeeds) {
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    const SphDef d = column(2, solver, Precision::f32);
    SphRun run(d, 0.01, {0, -9.81, 0}), copy(d, 0.01, {0, -9.81, 0});
    run.step(3);
    copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
    for (int k = 0; k < 3; ++k) {
      run.workspace.clear();
      run.step(), copy.step();
    }
    EXPECT_EQ(run.state.hash(), copy.state.hash());
  }
}

/// Water at a turning box of triangles on ground.
SphDef at_meshes(Method solver) {
  SphDef d = column(3, solver, Precision::f32);
  d.bodies = {{.center = {0.5, 0.5, 0.5}, .half_extents = {0.5, 0.5, 0.5}}};
  MeshColliderDef mesh = testing_rig::box_of_triangles({0.5, 0.6, 0.5}, {0.2, 0.2, 0.2});
  mesh.motion = MotionDef{};
  mesh.motion->spin = {1, 2, 0};
  HeightFieldColliderDef ground;
  ground.count = {2, 2}, ground.heights = {0, 0.2, 0.1, 0.3}, ground.center = {0.5, 0, 0.5};
  d.colliders = {mesh, ground};
  return d;
}

TEST(SphDeterminism, MeshesToo) {
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    const SphDef d = at_meshes(solver);
    SphRun one(d, 0.01, {0, -9.81, 0}, 1), two(d, 0.01, {0, -9.81, 0}, 2), copy(d, 0.01, {0, -9.81, 0});
    one.step(3), two.step(3);
    EXPECT_EQ(one.state.hash(), two.state.hash());
    copy.state = State::deserialize(one.state.serialize()), copy.steps = one.steps;
    one.workspace.clear();
    one.step(2), copy.step(2);
    EXPECT_EQ(one.state.hash(), copy.state.hash());
    SphDef other = d;
    other.colliders.pop_back();
    other.bodies = d.bodies;
    SphRun without(other, 0.01, {0, -9.81, 0});
    EXPECT_NE(without.system.setting().rows, one.system.setting().rows) << "control: the ground counts";
  }
}

}  // namespace
}  // namespace truestep::sph
