// Errors in a scene or a command of shallow water are reported with their place; steps that are far too long
// are subdivided or refused with one that works.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/fluids/shallow_run.h"

namespace truestep::test {
namespace {

using namespace heightfield_wave;

std::string fault_pointer(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.issues().empty() ? "" : e.issues()[0].pointer;
  }
  return "nothing was refused";
}

std::vector<std::string> reported(const HeightfieldWaveDef& d) {
  std::vector<std::string> out;
  heightfield_wave_table().check(
      &d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

TEST(HeightfieldWaveFaults, TextsAndMembersAreRefusedWithTheirPlace) {
  using List = std::vector<std::string>;
  HeightfieldWaveDef d;
  d.cells = {8, 8};
  EXPECT_EQ(reported(d), List{});
  d.bed = "oops";
  EXPECT_EQ(fault_pointer([&] { ShallowRun run(d, 0.1); }), "/bed");
  d.bed = "0", d.surface = "sin(t)";
  EXPECT_EQ(fault_pointer([&] { ShallowRun run(d, 0.1); }), "/surface");
  d.surface = "1", d.velocity = {"0", "1 +"};
  EXPECT_EQ(fault_pointer([&] { ShallowRun run(d, 0.1); }), "/velocity/1");
  d.velocity = {"0"};
  EXPECT_EQ(reported(d), List{"/velocity"});
  d.velocity.clear(), d.size = {1};
  EXPECT_EQ(reported(d), List{"/size"});
  d.size.clear(), d.cells = {8};
  d.sides.y_min = EdgeDef{};
  EXPECT_EQ(reported(d), List{"/sides/y_min"});
}

TEST(HeightfieldWaveFaults, CommandsAreRefused) {
  HeightfieldWaveDef d;
  d.cells = {8, 8};
  d.bed = "x > 0.5 ? 1 : 0";
  ShallowRun run(d, 0.1);
  const auto refused = [&](Command c) { return fault_pointer([&] { run.system->apply(run.state, c); }); };
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = 1, .name = "colour"}), "/name");
  EXPECT_EQ(refused({.kind = CommandKind::set_parameter, .value = -1, .name = "friction"}), "/value");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}}), "/at");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}, .at = Vec3{2, 0, 0}}), "/at");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {1, 0, 0}, .at = Vec3{0.9, 0.5, 0}}), "/at");
  EXPECT_EQ(refused({.kind = CommandKind::pin}), "/type");
  EXPECT_EQ(refused({.kind = CommandKind::impulse, .vector = {3, 0, 0}, .at = Vec3{0.2, 0.5, 0}}),
            "nothing was refused");
  EXPECT_NEAR(run.observed("momentum.x"), 3, 1e-12);
}

TEST(HeightfieldWaveFaults, StepsThatAreFarTooLongAreDividedOrRefused) {
  HeightfieldWaveDef d;
  d.cells = {40};
  d.surface = "x < 0.5 ? 1 : 0";
  ShallowRun run(d, 1);  // crosses 300 cells
  run.steps(3);
  EXPECT_GT(run.observed("substeps"), 100);
  EXPECT_LE(run.observed("cfl"), 0.5);
  EXPECT_NEAR(run.observed("mass"), 500, 1e-9);
  ShallowRun far(d, 1000);
  try {
    far.steps(1);
    FAIL() << "a step of 1000 s";
  } catch (const Instability& e) {
    ASSERT_GT(e.suggested_dt, 0);
    ShallowRun shorter(d, e.suggested_dt);
    shorter.steps(1);
    EXPECT_TRUE(std::isfinite(shorter.observed("energy.total")));
  }
}

}  // namespace
}  // namespace truestep::test
