// The animation systems: prescribed motion, its velocities, and the effects of commands.
#include "engine/base/errors.h"
#include "tests/unit/animation/animation_rig.h"

namespace truestep {
namespace {

using keyframes::Keyframes;
using keyframes::KeyframesDef;
using skeleton::Skeleton;
using skeleton::SkeletonDef;
using testing_rig::AnimationRun;

TEST(Keyframes, BodiesHaveTheVelocitiesOfTheirMotion) {
  KeyframesDef d;
  d.shapes.resize(1);
  d.shapes[0].id = "a";
  d.shapes[0].position = {"sin(t)", "2*t", "0"}, d.shapes[0].rotation = {"0", "3*t", "0"};
  const double h = 1e-3;
  AnimationRun<Keyframes> run(d, h);
  run.step(500);
  std::vector<double> scratch;
  const auto at = [&](size_t field) {
    return load3(static_cast<const double*>(run.system->field(run.state, 0, field, scratch).data), 0);
  };
  EXPECT_LT(norm(at(0) - Vec3{std::sin(0.5), 1, 0}), 1e-12);
  // The mean velocity over the step is that at its middle, to h^2.
  EXPECT_LT(norm(at(1) - Vec3{std::cos(0.5 - h / 2), 2, 0}), 1e-6);
  EXPECT_LT(norm(at(3) - Vec3{0, 3, 0}), 1e-9);
  const Ports ports = run.system->ports();
  ASSERT_TRUE(ports.bodies.has_value());
  EXPECT_FALSE(ConstBodies(run.state, *ports.bodies).dynamic(0)) << "nothing moves it";
  // At the start, the velocities are already those of the first step.
  EXPECT_LT(norm(load3(run.system->initial_state().f64(1).data(), 0) - Vec3{1, 2, 0}), 1e-6);
}

TEST(Keyframes, FramesAreHeld) {
  KeyframesDef d;
  d.frame_rate = 24;
  d.shapes.resize(1);
  d.shapes[0].id = "a", d.shapes[0].position = {"t"};
  AnimationRun<Keyframes> run(d, 1.0 / 240);
  for (int k = 1; k <= 100; ++k) {
    run.step();
    EXPECT_EQ(run.observe("shape.a.x"), (k / 10) / 24.0) << k;
  }
}

TEST(Keyframes, ControlsAreSetAndOthersFollow) {
  KeyframesDef d;
  d.controls.resize(3);
  d.controls[0].name = "a", d.controls[0].times = {0, 1}, d.controls[0].values = {0, 1};
  d.controls[1].name = "b", d.controls[1].value = "2*a";
  d.controls[2].name = "c", d.controls[2].value = "b + p_x";
  d.paths.resize(1);
  d.paths[0].name = "p", d.paths[0].times = {0, 2}, d.paths[0].points = {{0, 0, 0}, {4, 0, 0}};
  d.paths[0].even_speed = true;
  AnimationRun<Keyframes> run(d, 0.25);
  run.step(2);
  EXPECT_NEAR(run.observe("control.c"), 1 + 1, 1e-12);
  run.system->apply(run.state, {.kind = CommandKind::set_parameter, .value = 5, .name = "a"});
  EXPECT_NEAR(run.observe("control.c"), 10 + 1, 1e-12);
  EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::set_parameter, .name = "z"}), Error);
  EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::push, .index = 0}), Error);
}

TEST(Keyframes, StretchedShapesArePublishedAsTriangles) {
  KeyframesDef d;
  d.shapes.resize(1);
  d.shapes[0].id = "ball", d.shapes[0].radius = 1, d.shapes[0].scale = {"1", "1 - t", "1"};
  AnimationRun<Keyframes> run(d, 0.25);
  run.step(2);
  const Ports ports = run.system->ports();
  ASSERT_TRUE(ports.points.has_value());
  EXPECT_FALSE(ports.solids.triangles.empty());
  const ConstPoints points(run.state, *ports.points);
  EXPECT_NEAR(points.place(0).y, 0.5, 1e-15);
  EXPECT_NEAR(points.velocity(0).y, -1, 1e-12);
  EXPECT_EQ(points.inverse_mass(0), 0);
}

TEST(SkeletonSystem, AHandDragsAJoint) {
  SkeletonDef d;
  for (int j = 0; j < 4; ++j) {
    skeleton::JointDef joint;
    joint.id = "j" + std::to_string(j);
    if (j > 0) joint.parent = "j" + std::to_string(j - 1), joint.offset = {0.3, 0, 0};
    d.joints.push_back(joint);
  }
  AnimationRun<Skeleton> run(d);
  run.system->apply(run.state, {.kind = CommandKind::drag, .index = 3, .vector = {0.3, 0.5, 0.1}});
  run.step(3);
  EXPECT_NEAR(run.observe("joint.j3.y"), 0.5, 1e-3);
  run.system->apply(run.state, {.kind = CommandKind::release});
  run.step(3);
  EXPECT_NEAR(run.observe("joint.j3.y"), 0.5, 1e-3) << "what nothing drives stays";
  EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::drag, .index = 4}), Error);
}

TEST(SkeletonSystem, ExpressionsKeysAndLimitsDriveJoints) {
  SkeletonDef d;
  d.turns.resize(1);
  d.turns[0].name = "nod", d.turns[0].times = {0, 1}, d.turns[0].quaternions = {1, 0, 0, 0, 1, 0, 0, 1};
  d.joints.resize(3);
  d.joints[0].id = "a", d.joints[0].turn = "nod";
  d.joints[1].id = "b", d.joints[1].parent = "a", d.joints[1].offset = {1, 0, 0};
  d.joints[1].type = animation::JointKind::prismatic, d.joints[1].axis = {1, 0, 0}, d.joints[1].value = "9*t";
  d.joints[1].max = 0.5;
  d.joints[2].id = "c", d.joints[2].parent = "b", d.joints[2].type = animation::JointKind::fixed;
  d.joints[2].offset = {0, 0.5, 0};
  AnimationRun<Skeleton> run(d, 0.5);
  run.step(2);
  // A quarter turn about z, 1 m and the 0.5 m that the limit leaves of the slide.
  EXPECT_NEAR(run.observe("joint.b.y"), 1.5, 1e-12);
  EXPECT_NEAR(run.observe("joint.c.x"), -0.5, 1e-12);
}

TEST(AnimationScene, WhatIsNotFiniteIsToldAndNeverANumber) {
  SkeletonDef d;
  d.joints.resize(1);
  d.joints[0].id = "a", d.joints[0].end = Vec3{1, 0, 0};
  d.goals.resize(1);
  d.goals[0].joint = "a", d.goals[0].target = {"sqrt(0.05 - t)"};
  AnimationRun<Skeleton> run(d);
  run.step(2);
  EXPECT_THROW(run.step(2), Instability);
  KeyframesDef k;
  k.shapes.resize(1);
  k.shapes[0].id = "a", k.shapes[0].rotation = {"sqrt(0.05 - t)"};
  AnimationRun<Keyframes> turning(k);
  turning.step(2);
  EXPECT_THROW(turning.step(2), Instability);
}

}  // namespace
}  // namespace truestep
