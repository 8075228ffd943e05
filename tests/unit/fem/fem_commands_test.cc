// Commands to bodies of finite elements.
#include "engine/base/errors.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

FemDef block() {
  FemDef d;
  d.block = SoftBlockShape{.cells_x = 2, .cells_y = 2, .cells_z = 2};
  d.youngs_modulus = 1e4;
  return d;
}

std::string refused(const FemRun& run, const Command& c) {
  State copy = run.state;
  try {
    run.system->apply(copy, c);
  } catch (const Error& e) {
    return e.issues().at(0).pointer;
  }
  return "";
}

TEST(FemCommands, HandsPushHitPinAndDrag) {
  FemRun run(block(), 1.0 / 60, {});
  const size_t corner = run.node_at({1, 1, 1}), base = run.node_at({0, 0, 0});
  run.system->apply(run.state, {.kind = CommandKind::impulse, .index = int64_t(corner), .vector = {0, 0, 2}});
  run.system->apply(
      run.state, {.kind = CommandKind::push, .index = int64_t(corner), .vector = {6, 0, 0}, .duration = 0.5});
  run.seconds(1);
  // Force times time and the blow, whatever the body does: nothing else acts on it. Newton's tolerance.
  EXPECT_NEAR(run.observe("momentum.x"), 3, 1e-6);
  EXPECT_NEAR(run.observe("momentum.z"), 2, 1e-6);
  run.system->apply(run.state, {.kind = CommandKind::pin, .index = int64_t(base)});
  const Vec3 held = run.position(base);
  run.system->apply(
      run.state, {.kind = CommandKind::drag, .index = int64_t(corner), .vector = {1.2, 1, 1}, .value = 500});
  run.seconds(0.5);
  EXPECT_EQ(run.position(base), held);
  run.system->apply(run.state, {.kind = CommandKind::release});
  run.system->apply(run.state, {.kind = CommandKind::unpin, .index = int64_t(base)});
  run.seconds(0.2);
  EXPECT_NE(run.position(base), held);
}

TEST(FemCommands, WhatIsPrescribedIsNotHit) {
  FemDef d = block();
  d.holds = {{.on = "bottom", .y = "0"}};
  FemRun run(d);
  const auto node = int64_t(run.node_at({0, 0, 0}));
  run.system->apply(run.state, {.kind = CommandKind::impulse, .index = node, .vector = {1, 1, 1}});
  EXPECT_EQ(run.velocity(size_t(node)).y, 0);
  EXPECT_GT(run.velocity(size_t(node)).x, 0);
}

TEST(FemCommands, SayWhatTheyCannotDo) {
  const FemRun run(block());
  EXPECT_EQ(refused(run, {.kind = CommandKind::spawn}), "/type");
  EXPECT_EQ(refused(run, {.kind = CommandKind::pin, .index = 27}), "/index");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = 1, .name = "colour"}), "/name");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = 0, .name = "youngs_modulus"}),
            "/value");
  EXPECT_EQ(refused(run, {.kind = CommandKind::set_parameter, .value = 2e4, .name = "youngs_modulus"}), "");
  FemDef plane;
  plane.quad = QuadShape{};
  EXPECT_EQ(refused(FemRun(plane), {.kind = CommandKind::impulse, .index = 0, .vector = {0, 0, 1}}),
            "/vector");
  FemDef held = block();
  held.holds = {{.on = "bottom"}};
  const FemRun fixed(held);
  EXPECT_EQ(refused(fixed, {.kind = CommandKind::unpin, .index = int64_t(fixed.node_at({0, 0, 0}))}),
            "/index");
}

}  // namespace
}  // namespace truestep::fem
