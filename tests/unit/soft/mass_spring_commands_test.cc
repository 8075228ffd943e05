// The effects of commands on a network of springs, what is refused, and the other interfaces of the system.
#include "engine/base/errors.h"
#include "tests/support/drawn.h"
#include "tests/unit/soft/mass_spring_rig.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::SpringRun;

MassSpringDef rope() {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 0, 0}, .to = {1, 0, 0}, .links = 10};
  d.pinned = {"first"};
  return d;
}

MassSpringDef lone_point() {
  MassSpringDef d;
  d.free = FreeShape{.points = {{0, 0, 0}}, .masses = {2}};
  return d;
}

Command command(CommandKind kind, int64_t index, Vec3 vector = {}) {
  Command c;
  c.kind = kind, c.index = index, c.vector = vector;
  return c;
}

// A force F on a free mass m for a time d gives the velocity F d / m, however many steps that takes.
TEST(MassSpringCommands, PushLastsItsDuration) {
  for (const double h : {0.01, 0.02, 0.05}) {
    SpringRun run(lone_point(), {});
    Command c = command(CommandKind::push, 0, {6, 0, 0});
    c.duration = 0.2;
    run.system->apply(run.state, c);
    run.step(h, 40);
    EXPECT_NEAR(run.velocity(0).x, 6 * 0.2 / 2, 1e-12) << h;
  }
  SpringRun once(lone_point(), {});
  once.system->apply(once.state, command(CommandKind::push, 0, {6, 0, 0}));
  once.step(0.01, 5);
  EXPECT_NEAR(once.velocity(0).x, 6 * 0.01 / 2, 1e-15);
}

TEST(MassSpringCommands, ImpulseChangesMomentumAtOnce) {
  SpringRun run(lone_point(), {});
  run.system->apply(run.state, command(CommandKind::impulse, 0, {1, 2, 3}));
  EXPECT_EQ(run.velocity(0), (Vec3{0.5, 1, 1.5}));
  EXPECT_DOUBLE_EQ(run.observe("momentum.z"), 3);
}

TEST(MassSpringCommands, DragPullsUntilReleased) {
  MassSpringDef def = rope();
  def.damping = 0.2;
  SpringRun run(def);
  run.system->apply(run.state, command(CommandKind::drag, 10, {0.5, 0.4, 0}));
  run.system->apply(run.state, command(CommandKind::drag, 10, {0.5, 0.5, 0}));  // moves the target
  ASSERT_EQ(run.state.rows(MassSpringColumns::drag_row), 1u);
  run.step(0.001, 5000);
  EXPECT_LT(norm(run.position(10) - Vec3{0.5, 0.5, 0}), 0.01);
  run.system->apply(run.state, command(CommandKind::release, -1));
  EXPECT_EQ(run.state.rows(MassSpringColumns::drag_row), 0u);
  run.step(0.001, 5000);
  EXPECT_LT(run.position(10).y, -0.5);
}

TEST(MassSpringCommands, PinHoldsAndUnpinLetsGo) {
  SpringRun run(rope());
  run.system->apply(run.state, command(CommandKind::pin, 10));
  EXPECT_EQ(run.observe("pins"), 2);
  run.step(0.001, 200);
  EXPECT_EQ(run.position(10), (Vec3{1, 0, 0}));
  EXPECT_EQ(run.position(0), Vec3{});
  EXPECT_LT(run.position(5).y, -0.01);
  run.system->apply(run.state, command(CommandKind::unpin, 10));
  run.step(0.001, 200);
  EXPECT_LT(run.position(10).y, -0.01);
}

TEST(MassSpringCommands, ParametersCanBeSet) {
  MassSpringDef def;
  def.cloth_grid = ClothGridShape{.nx = 4, .ny = 4};
  def.bending_stiffness = 5;
  SpringRun run(def);
  for (const char* name :
       {"stiffness", "shear_stiffness", "bending_stiffness", "damping", "internal_damping"}) {
    Command c = command(CommandKind::set_parameter, -1);
    c.name = name, c.value = 3;
    const uint64_t before = run.state.hash();
    run.system->apply(run.state, c);
    EXPECT_NE(run.state.hash(), before) << name;
  }
  Command wind = command(CommandKind::set_parameter, -1, {0, 5, 0});
  wind.name = "wind";
  run.system->apply(run.state, wind);
  Command weightless = command(CommandKind::set_parameter, -1);
  weightless.name = "gravity";
  run.system->apply(run.state, weightless);
  run.step(0.001, 10);
  EXPECT_GT(run.velocity(5).y, 1e-4);
}

std::string refused_member(const SpringRun& run, const Command& c) {
  State copy = run.state;
  try {
    run.system->apply(copy, c);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "bad_command");
    EXPECT_EQ(copy, run.state);
    return e.issues().at(0).pointer;
  }
  return "accepted";
}

TEST(MassSpringCommands, NonsenseIsRefusedAndChangesNothing) {
  const SpringRun run(rope());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused_member(run, command(CommandKind::pin, 11)), "/index");
  EXPECT_EQ(refused_member(run, command(CommandKind::push, -1)), "/index");
  EXPECT_EQ(refused_member(run, command(CommandKind::push, 3, {nan, 0, 0})), "/vector");
  EXPECT_EQ(refused_member(run, command(CommandKind::spawn, 0)), "/type");
  Command c = command(CommandKind::set_parameter, -1);
  c.name = "stifness";
  EXPECT_EQ(refused_member(run, c), "/name");
  c.name = "shear_stiffness";  // a rope has none
  EXPECT_EQ(refused_member(run, c), "/name");
  c.name = "damping", c.value = -1;
  EXPECT_EQ(refused_member(run, c), "/value");
  EXPECT_EQ(refused_member(run, command(CommandKind::release, 3)), "accepted");
}

TEST(MassSpringSystem, PlanNamesWhatRunsAndWhatDoesNot) {
  MassSpringDef def = rope();
  const auto status = [&](const std::string& name) {
    for (const PlanRow& row : SpringRun(def).system->plan()) {
      if (row.name == name) return row.status == PlanRow::Status::runs ? "runs" : "skipped";
    }
    return "absent";
  };
  EXPECT_STREQ(status("integrate"), "runs");
  EXPECT_STREQ(status("contacts"), "skipped");
  EXPECT_STREQ(status("air"), "skipped");
  EXPECT_STREQ(status("internal damping"), "skipped");
  def.colliders.push_back(SphereColliderDef{});
  def.wind = Vec3{1, 0, 0};
  EXPECT_STREQ(status("contacts"), "runs");
  EXPECT_STREQ(status("air"), "absent");
}

TEST(MassSpringSystem, LazyFieldsHoldForceAndStrain) {
  SpringRun run(rope());
  run.x()[30] += 0.05;  // the last of ten links of 0.1 m, stretched by half
  std::vector<double> scratch;
  ASSERT_EQ(run.system->parts()[0].fields.size(), 5u);
  const FieldView strain = run.system->field(run.state, 0, 3, scratch);
  EXPECT_NEAR(static_cast<const double*>(strain.data)[10], 0.5, 1e-12);
  EXPECT_NEAR(static_cast<const double*>(strain.data)[3], 0, 1e-12);
  const FieldView force = run.system->field(run.state, 0, 2, scratch);
  EXPECT_NEAR(static_cast<const double*>(force.data)[30], -1000 * 0.05, 1e-9);
  const FieldView springs = run.system->field(run.state, 1, 0, scratch);
  ASSERT_EQ(springs.rows, 10u);
  EXPECT_NEAR(static_cast<const double*>(springs.data)[9], 0.5, 1e-12);
  EXPECT_NEAR(run.observe("strain.max"), 0.5, 1e-12);
}

TEST(MassSpringSystem, TopologyDrawsEverySpring) {
  MassSpringDef def;
  def.cloth_grid = ClothGridShape{.nx = 3, .ny = 3};
  def.bending_stiffness = 1;
  const SpringRun run(def);
  const PartDrawing t = testing::drawn(*run.system, run.state).parts[0];
  EXPECT_EQ(t.triangles.size(), 8u);
  EXPECT_EQ(std::count(t.line_kinds.begin(), t.line_kinds.end(), LineKind::structural), 12);
  EXPECT_EQ(std::count(t.line_kinds.begin(), t.line_kinds.end(), LineKind::shear), 8);
  EXPECT_EQ(std::count(t.line_kinds.begin(), t.line_kinds.end(), LineKind::bending), 6);
}

TEST(MassSpringSystem, ClothStaysOutOfASphere) {
  MassSpringDef def;
  def.cloth_grid = ClothGridShape{.origin = {-0.5, 0.6, -0.5}, .nx = 21, .ny = 21};
  def.damping = 0.01;
  def.colliders.push_back(SphereColliderDef{{}, {0, 0, 0}, 0.4, false});
  SpringRun run(def);
  double lowest = 1;
  for (int i = 0; i < 1000; ++i) {
    run.step(0.001);
    for (size_t p = 0; p < 441; ++p) lowest = std::min(lowest, norm(run.position(p)));
  }
  EXPECT_GE(lowest, 0.4 + 0.005 - 1e-12);  // radius + half the thickness
  EXPECT_LT(run.position(0).y, 0.2);       // the corners hang down beside it
  EXPECT_GT(run.position(220).y, 0.4);     // the middle lies on top
}

std::vector<std::string> complaints(const MassSpringDef& def) {
  std::vector<std::string> pointers;
  mass_spring_table().check(&def, [&](const std::string& p, const std::string&) { pointers.push_back(p); });
  return pointers;
}

TEST(MassSpringDefs, InconsistentScenesAreNamed) {
  EXPECT_EQ(complaints({}), std::vector<std::string>{""});
  MassSpringDef def = rope();
  EXPECT_TRUE(complaints(def).empty());
  def.pins = {0, 11};
  def.pinned = {"last", "corners"};
  EXPECT_EQ(complaints(def), (std::vector<std::string>{"/pins/1", "/pinned/1"}));
  def.hair = HairShape{};
  EXPECT_EQ(complaints(def), std::vector<std::string>{""});
}

}  // namespace
}  // namespace truestep
