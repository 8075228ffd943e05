// Drawn bodies: one visual per shape and part, groups, versions, and contacts that carry the weight.
#include <gtest/gtest.h>

#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "tests/support/drawn.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::ball;
using testing::box;
using testing::ground;
using testing::RigidRun;

TEST(DrawnBodies, EveryShapeHasAVisual) {
  Rigid3dDef def;
  HullBodyDef hull;
  hull.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  hull.position = {5, 3, 0};
  CylinderBodyDef drum;
  drum.position = {8, 3, 0};
  CapsuleBodyDef pill;
  pill.position = {11, 3, 0};
  CompoundBodyDef two;
  two.parts = {SpherePartDef{}, BoxPartDef{}};
  std::get<BoxPartDef>(two.parts[1]).position = {1, 0, 0};
  two.position = {14, 3, 0};
  HeightFieldBodyDef field;
  field.motion = BodyDef::Motion::fixed, field.heights = {0, 0, 0, 0}, field.position = {0, -9, 0};
  def.bodies = {ground(), box({1, 1, 1}, {0, 3, 0}), ball(0.5, {3, 3, 0}), hull, drum, pill, two, field};
  const RigidRun run(def);
  const Drawing all = testing::drawn(*run.system, run.state);
  const PartDrawing& drawn = all.parts[0];
  using Kind = DrawnShape::Kind;
  std::vector<Kind> kinds;
  for (const Visual& v : drawn.visuals) kinds.push_back(v.shape.kind);
  EXPECT_EQ(kinds, (std::vector<Kind>{Kind::box, Kind::sphere, Kind::mesh, Kind::cylinder, Kind::capsule,
                                      Kind::sphere, Kind::box, Kind::mesh}));
  EXPECT_EQ(drawn.instances.size(), 8u);
  EXPECT_EQ(drawn.instances[6], (std::array<uint32_t, 2>{6, 6}));  // the compound's second part, on its row
  EXPECT_EQ(drawn.visuals.back().motion, Visual::Motion::fixed);
  EXPECT_EQ(all.obstacles.size(), 1u);  // the plane
  // A compound's parts stand about its centre of mass.
  const double apart = norm(drawn.visuals[6].shape.position - drawn.visuals[5].shape.position);
  EXPECT_NEAR(apart, 1, 1e-12);
}

TEST(DrawnBodies, AlikeBodiesShareAGroup) {
  Rigid3dDef def;
  def.bodies = {ground(), ball(0.5, {0, 1, 0}), ball(0.7, {2, 1, 0}), ball(0.5, {4, 1, 0})};
  const RigidRun run(def);
  const PartDrawing drawn = testing::drawn(*run.system, run.state).parts[0];
  EXPECT_EQ(drawn.visuals[0].group, drawn.visuals[2].group);
  EXPECT_NE(drawn.visuals[0].group, drawn.visuals[1].group);
}

TEST(DrawnBodies, TheVersionGrowsWithBirthsAndRemovals) {
  Rigid3dDef def;
  def.bodies = {ground(), ball(0.5, {0, 1, 0}), ball(0.5, {3, 1, 0})};
  RigidRun run(def);
  const uint32_t before = testing::drawn(*run.system, run.state).version;
  run.run(3);
  EXPECT_EQ(testing::drawn(*run.system, run.state).version, before);
  Command remove;
  remove.kind = CommandKind::remove, remove.index = 1;
  run.apply(remove);
  EXPECT_EQ(testing::drawn(*run.system, run.state).version, before + 1);
  EXPECT_EQ(testing::drawn(*run.system, run.state).parts[0].instances.size(), 1u);
}

TEST(DrawnBodies, ContactsCarryTheWeight) {
  Rigid3dDef def;
  def.bodies = {ground(), box({0.5, 0.5, 0.5}, {0, 0.5, 0})};
  RigidRun run(def);
  EXPECT_TRUE(testing::drawn(*run.system, run.state).contacts.empty());
  run.run(60);
  double force = 0;
  const auto marks = testing::drawn(*run.system, run.state).contacts;
  for (const ContactMark& m : marks) {
    force += m.force;
    EXPECT_NEAR(m.point.y, 0, 2e-3);
    EXPECT_NEAR(std::abs(m.normal.y), 1, 1e-9);
  }
  EXPECT_EQ(marks.size(), 4u);
  EXPECT_NEAR(force, 1000 * 9.81, 20);  // a cubic metre of water's density; impulses of the last substep
}

constexpr const char* kTwoBoxes = R"({"schema_version": "1.0", "name": "two boxes", "time": {"dt": 0.01},
  "viewer": {"camera": {"eye": [0, 0, 10], "target": [0, 0, 0]}},
  "systems": [{"type": "rigid3d", "id": "b", "gravity": [0, 0, 0], "bodies": [
    {"type": "box", "position": [-1.5, 0, 0], "color": [0.9, 0.1, 0.1]},
    {"type": "cylinder", "position": [1.5, 0, 0], "color": [0.1, 0.1, 0.9]}]}]})";

TEST(DrawnBodies, SleepersAreDarker) {
  const Session session(std::make_shared<const World>(parse_scene(kTwoBoxes)),
                        std::make_shared<const ThreadArena>(1));
  WorldState state = session.state();
  const auto pictured = [&] {
    return draw_list_of(session.world(), *session.frame_of(state, picture_request(session.world())));
  };
  const DrawList awake = pictured();
  state.systems[0].span<uint32_t>(rigid3d::columns::asleep)[0] = 1;
  const DrawList asleep = pictured();
  ASSERT_EQ(awake.shapes.size(), 2u);
  EXPECT_FLOAT_EQ(awake.shapes[0].color->r, 0.9f);
  EXPECT_LT(asleep.shapes[0].color->r, 0.7f);
  EXPECT_FLOAT_EQ(asleep.shapes[1].color->b, awake.shapes[1].color->b);  // control
}

}  // namespace
}  // namespace truestep
