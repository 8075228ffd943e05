// Commands that act at a point of a body in the plane: an off-centre impulse turns it, a drag keeps hold of
// its point. And how bodies are drawn: equal ones share a mesh, joined ones are in layers.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/rigid2d.h"
#include "tests/support/drawn.h"
#include "tests/support/runs/system_run.h"

namespace truestep::rigid2d {
namespace {

struct Trial : testing_rig::SystemRun<Rigid2d> {
  explicit Trial(const Rigid2dDef& def)
      : SystemRun([&] { return Rigid2d(def, BuildContext{.id = "r", .gravity = {}, .dt = 1.0 / 60}); },
                  1.0 / 60) {}
  void run(uint64_t count) { step(count); }
};

BodyDef square(Vec3 at) {
  BodyDef b;
  b.position = at, b.mass = 2;
  b.shapes = {BoxDef{}};
  return b;
}

Command impulse(std::optional<Vec3> at) {
  Command c;
  c.kind = CommandKind::impulse, c.index = 0, c.vector = {0, 3, 0}, c.at = at;
  return c;
}

TEST(Rigid2dHold, AnImpulseOffTheCentreTurns) {
  Rigid2dDef def;
  def.bodies = {square({4, 1, 0})};
  Trial run(def);
  run.system.apply(run.state, impulse(Vec3{4.5, 1, 0}));
  EXPECT_NEAR(run.state.f64(columns::velocity)[1], 1.5, 1e-12);
  // A square of 1 m has I = m / 6: w = 0.5 * 3 / (2 / 6).
  EXPECT_NEAR(run.state.f64(columns::angular_velocity)[0], 4.5, 1e-12);
  // Control: without a point it acts at the centre.
  Trial other(def);
  other.system.apply(other.state, impulse(std::nullopt));
  EXPECT_EQ(other.state.f64(columns::angular_velocity)[0], 0);
}

TEST(Rigid2dHold, ADragHoldsThePointThatItTook) {
  Rigid2dDef def;
  def.bodies = {square({0, 0, 0})};
  def.bodies[0].angular_damping = 3;  // otherwise it would swing about the drag forever
  Trial run(def);
  Command drag;
  drag.kind = CommandKind::drag, drag.index = 0, drag.vector = {0.5, 2, 0}, drag.at = Vec3{0.5, 0, 0};
  run.system.apply(run.state, drag);
  run.run(5);
  drag.at.reset();  // goes on, at the same point
  run.system.apply(run.state, drag);
  run.run(600);
  // The point at the spring's end is the middle of the right edge, not the centre.
  const Pose pose = pose_of(run.state, 0);
  EXPECT_NEAR((pose * Vec2{0.5, 0}).x, 0.5, 0.01);
  EXPECT_NEAR((pose * Vec2{0.5, 0}).y, 2, 0.01);
  EXPECT_GT(flat::norm(pose.p - Vec2{0.5, 2}), 0.4);  // control
}

TEST(Rigid2dHold, RowsAreBodies) {
  Rigid2dDef def;
  def.bodies = {square({0, 0, 0}), square({3, 0, 0})};
  const Trial run(def);
  std::vector<double> scratch;
  const auto& fields = run.system.parts()[0].fields;
  for (size_t f = 0; f < fields.size(); ++f)
    EXPECT_EQ(run.system.field(run.state, 0, f, scratch).rows, 2u) << fields[f].name;
  const PartDrawing drawn = testing::drawn(run.system, run.state).parts[0];
  EXPECT_EQ(drawn.visuals.size(), 1u);
  EXPECT_EQ(drawn.instances.size(), 2u);
}

TEST(Rigid2dHold, JoinedBodiesStandInLayers) {
  Rigid2dDef def;
  def.bodies = {square({0, 0, 0}), square({0.8, 0, 0})};
  RevoluteDef joint;
  joint.a = 0, joint.b = 1, joint.anchor = {0.4, 0, 0};
  def.joints = {joint};
  const Trial run(def);
  const Drawing all = testing::drawn(run.system, run.state);
  const PartDrawing& drawn = all.parts[0];
  ASSERT_EQ(drawn.visuals.size(), 2u);
  EXPECT_GT(std::abs(drawn.visuals[0].shape.position.z - drawn.visuals[1].shape.position.z), 0.01);
  EXPECT_EQ(drawn.visuals[0].shape.mesh, drawn.visuals[1].shape.mesh);
  const auto& marks = all.joints;
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_NEAR(marks[0].a.x, 0.4, 1e-12);
  EXPECT_EQ(marks[0].kind, JointMark::Kind::revolute);
}

}  // namespace
}  // namespace truestep::rigid2d
