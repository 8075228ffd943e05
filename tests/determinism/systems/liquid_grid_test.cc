// A liquid on a grid gives the same bits for any number of threads, with a discarded workspace, and from a
// restored snapshot.
#include <gtest/gtest.h>

#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

struct LiquidKind {
  const char* name;
  A advection;
  bool space, periodic;
  bool moves = false;
  bool changes = false;  ///< particles come and go
};

std::unique_ptr<LiquidRun> make_liquid(const LiquidKind& k, int threads) {
  GridFluidDef d =
      water(k.advection, k.space ? std::vector<int64_t>{20, 16, 12} : std::vector<int64_t>{48, 32}, 1.0 / 32);
  d.bodies = {box_of_liquid({0, 0, -1}, {0.25, 0.4, 1})};
  d.obstacles = {ObstacleDef{.center = {0.45, 0.1, 0.2}, .radius = 0.08}};
  if (k.moves) {
    d.obstacles[0].shape = ObstacleDef::Shape::box, d.obstacles[0].half = {0.08, 0.04, 0.08};
    d.obstacles[0].displacement = {"-0.3*t", "0"};
    if (k.space) d.obstacles[0].displacement.emplace_back("0");
    d.obstacles[0].angle = "2*t", d.viscosity = 1e-3;
  }
  if (k.periodic) d.sides.x_min = FlowSideDef{SideKind::periodic, {}};
  if (k.changes) {
    LiquidInletDef e;
    e.position = {0.9, 0.3, 0.2}, e.radius = 0.06, e.speed = 1.3, e.direction = {-1, 2, 0}, e.dye = 2;
    if (k.space) e.position.x = 0.3;
    d.emitters = {e}, d.max_particles = 4000;
    d.bodies.push_back(box_of_liquid({k.space ? 0.5 : 1.35, 0, -1}, {2, 0.2, 1}));
    d.kill_boxes = {
        {.center = {0.1, 0, 0}, .half_extents = {0.1, 0.1, 1}, .where = KillBoxDef::Where::inside}};
    d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
    d.sides.y_min = FlowSideDef{SideKind::inflow, {"0", "x < 0.3 ? 1 + sin(20*t) : 0"}};
    if (k.space) d.sides.y_min->velocity.emplace_back("0.1");
  }
  d.force =
      k.space ? std::vector<std::string>{"sin(9*t)", "0", "x"} : std::vector<std::string>{"sin(9*t)", "0"};
  return std::make_unique<LiquidRun>(d, 0.02, threads);
}

class LiquidBits : public ::testing::TestWithParam<LiquidKind> {};

TEST_P(LiquidBits, DoNotDependOnHowTheRunIsMade) {
  constexpr uint64_t kSteps = 10;
  const auto reference = make_liquid(GetParam(), 1);
  std::vector<std::byte> snapshot;
  for (uint64_t n = 0; n < kSteps; ++n) {
    if (n == kSteps / 2) snapshot = reference->state.serialize();
    reference->steps(1);
  }
  const uint64_t hash = reference->state.hash();
  ASSERT_NE(hash, reference->system->initial_state().hash());
  if (GetParam().changes) {
    for (const char* gone : {"emitted", "killed", "left"}) EXPECT_GT(reference->observed(gone), 0) << gone;
  }
  for (const int threads : {2, 5}) {
    const auto run = make_liquid(GetParam(), threads);
    run->steps(kSteps);
    EXPECT_EQ(run->state.hash(), hash) << threads << " threads";
  }
  const auto dropped = make_liquid(GetParam(), 1);
  for (uint64_t n = 0; n < kSteps; ++n) dropped->workspace.clear(), dropped->steps(1);
  EXPECT_EQ(dropped->state.hash(), hash) << "workspace dropped";
  const auto restored = make_liquid(GetParam(), 1);
  restored->state = State::deserialize(snapshot);
  restored->done() = kSteps / 2;
  restored->steps(kSteps - kSteps / 2);
  EXPECT_EQ(restored->state.hash(), hash) << "restored";
}

INSTANTIATE_TEST_SUITE_P(
    Liquids, LiquidBits,
    ::testing::Values(LiquidKind{"flip", A::flip, false, false}, LiquidKind{"apic", A::apic, false, true},
                      LiquidKind{"apic_moving_solid", A::apic, false, false, true},
                      LiquidKind{"flip_space", A::flip, true, true},
                      LiquidKind{"apic_space", A::apic, true, false},
                      LiquidKind{"flip_changes", A::flip, false, false, true, true},
                      LiquidKind{"apic_changes", A::apic, false, false, false, true},
                      LiquidKind{"apic_space_changes", A::apic, true, false, false, true}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace truestep::test
