// A flow on a grid gives the same bits for any number of threads, with a workspace that is discarded, and
// from a restored snapshot.
#include <gtest/gtest.h>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

struct FlowKind {
  const char* name;
  A advection;
  GridFluidDef::Stepping stepping;
  bool solid, space;
  bool moves = false;
};

std::unique_ptr<GridFlow> make_flow(const FlowKind& k, int threads) {
  GridFluidDef d;
  d.cells = k.space ? std::vector<int64_t>{16, 20, 12} : std::vector<int64_t>{40, 66};
  d.advection = k.advection, d.stepping = k.stepping;
  d.viscosity = 1e-3;
  d.scalar = ScalarDef{.initial = "x*y", .source = "sin(t)*x", .diffusivity = 1e-4, .expansion = 0.1};
  const FlowSideDef in{SideKind::inflow, k.space ? std::vector<std::string>{"1 + 0.1*sin(t)", "0", "0"}
                                                 : std::vector<std::string>{"1 + 0.1*sin(t)", "0"}};
  d.sides.x_min = in;
  d.sides.x_max = FlowSideDef{SideKind::outflow, {}};
  d.sides.y_min = FlowSideDef{SideKind::periodic, {}};
  d.vorticity_confinement = k.advection == A::central ? 0 : 0.2;
  if (k.solid) d.obstacles = {ObstacleDef{.center = {0.4, 0.5, 0.5}, .radius = 0.15}};
  if (k.moves) {
    d.obstacles[0].displacement = {"0.2*sin(3*t)", "0.1*t"};
    if (k.space) d.obstacles[0].displacement.emplace_back("0"), d.obstacles[0].axis = {1, 0, 1};
    d.obstacles[0].angle = "3*t";
    if (k.advection != A::central) d.obstacles[0].shape = ObstacleDef::Shape::box;
  }
  return std::make_unique<GridFlow>(d, 0.02, threads, Vec3{0, -9.81, 0});
}

TEST(GridFluidSteadyBits, DoNotDependOnHowTheRunIsMade) {
  const auto make_flow = [](int threads) {
    GridFluidDef d;
    d.cells = {32, 48};
    d.viscosity = 0.01, d.stepping = GridFluidDef::Stepping::steady, d.order = GridFluidDef::Order::fourth;
    d.sides.y_max = FlowSideDef{SideKind::wall, {"1", "0"}};
    d.sides.x_max = FlowSideDef{SideKind::slip, {}};
    return std::make_unique<GridFlow>(d, 0.1, threads);
  };
  const Command thinner{.kind = CommandKind::set_parameter, .value = 0.005, .name = "viscosity"};
  const auto run = [&](GridFlow& flow, uint64_t first, uint64_t last, bool drop) {
    for (uint64_t n = first; n < last; ++n) {
      if (n == 2) flow.system->apply(flow.state, thinner);
      if (drop) flow.workspace.clear();
      flow.steps(1);
    }
    return flow.state.hash();
  };
  const auto reference = make_flow(1);
  const uint64_t half = run(*reference, 0, 2, false);
  const auto snapshot = reference->state.serialize();
  const uint64_t hash = run(*reference, 2, 4, false);
  EXPECT_NE(hash, half) << "control: another viscosity is another flow";
  EXPECT_EQ(run(*make_flow(2), 0, 4, false), hash) << "2 threads";
  EXPECT_EQ(run(*make_flow(1), 0, 4, true), hash) << "workspace dropped";
  const auto restored = make_flow(1);
  restored->state = State::deserialize(snapshot);
  restored->done() = 2;
  EXPECT_EQ(run(*restored, 2, 4, false), hash) << "restored";
}

// Two fluids in the plane and in space, each with its viscosity or along paths.
TEST(GridFluidTwoFluidsBits, DoNotDependOnHowTheRunIsMade) {
  constexpr uint64_t kSteps = 4;
  for (const A advection : {A::central, A::maccormack}) {
    for (const bool space : {false, true}) {
      const auto make_flow = [&](int threads, double density) {
        GridFluidDef d;
        d.cells = space ? std::vector<int64_t>{10, 20, 12} : std::vector<int64_t>{24, 66};
        d.size = space ? std::vector<double>{1, 2, 1} : std::vector<double>{1, 2.75};
        d.advection = advection, d.viscosity = 1e-3;
        d.sides.x_min = FlowSideDef{SideKind::periodic, {}};
        d.second_fluid = SecondFluidDef{"y - 1 - 0.1*cos(2*pi*x)", density, {}};
        if (advection == A::central) d.second_fluid->viscosity = 5e-3;
        return std::make_unique<GridFlow>(d, 0.02, threads, Vec3{0, -9.81, 0});
      };
      const auto reference = make_flow(1, 100);
      reference->steps(kSteps / 2);
      const auto snapshot = reference->state.serialize();
      reference->steps(kSteps / 2);
      const uint64_t hash = reference->state.hash();
      for (const int threads : {2, 5}) {
        const auto run = make_flow(threads, 100);
        run->steps(kSteps);
        EXPECT_EQ(run->state.hash(), hash) << threads << " threads";
      }
      const auto dropped = make_flow(1, 100);
      for (uint64_t n = 0; n < kSteps; ++n) dropped->workspace.clear(), dropped->steps(1);
      EXPECT_EQ(dropped->state.hash(), hash) << "workspace dropped";
      const auto restored = make_flow(1, 100);
      restored->state = State::deserialize(snapshot);
      restored->done() = kSteps / 2;
      restored->steps(kSteps / 2);
      EXPECT_EQ(restored->state.hash(), hash) << "restored";
      const auto other = make_flow(1, 99);
      other->steps(kSteps);
      EXPECT_NE(other->state.hash(), hash) << "control";
    }
  }
}

class GridFluidBits : public ::testing::TestWithParam<FlowKind> {};

TEST_P(GridFluidBits, DoNotDependOnHowTheRunIsMade) {
  constexpr uint64_t kSteps = 4;
  const auto reference = make_flow(GetParam(), 1);
  std::vector<std::byte> snapshot;
  for (uint64_t n = 0; n < kSteps; ++n) {
    if (n == kSteps / 2) snapshot = reference->state.serialize();
    reference->steps(1);
  }
  const uint64_t hash = reference->state.hash();
  ASSERT_NE(hash, reference->system->initial_state().hash());
  for (const int threads : {2, 5}) {
    const auto run = make_flow(GetParam(), threads);
    run->steps(kSteps);
    EXPECT_EQ(run->state.hash(), hash) << threads << " threads";
  }
  const auto dropped = make_flow(GetParam(), 1);
  for (uint64_t n = 0; n < kSteps; ++n) dropped->workspace.clear(), dropped->steps(1);
  EXPECT_EQ(dropped->state.hash(), hash) << "workspace dropped";
  const auto restored = make_flow(GetParam(), 1);
  restored->state = State::deserialize(snapshot);
  restored->done() = kSteps / 2;
  restored->steps(kSteps - kSteps / 2);
  EXPECT_EQ(restored->state.hash(), hash) << "restored";
}

constexpr auto kRk3 = GridFluidDef::Stepping::rk3, kAb2 = GridFluidDef::Stepping::ab2;
INSTANTIATE_TEST_SUITE_P(Flows, GridFluidBits,
                         ::testing::Values(FlowKind{"rk3", A::central, kRk3, false, false},
                                           FlowKind{"ab2_solid", A::central, kAb2, true, false},
                                           FlowKind{"ab2_moving_solid", A::central, kAb2, true, false, true},
                                           FlowKind{"rk3_moving_solid", A::central, kRk3, true, true, true},
                                           FlowKind{"bfecc_moving_solid", A::bfecc, kRk3, true, false, true},
                                           FlowKind{"semi_lagrangian", A::semi_lagrangian, kRk3, false, true},
                                           FlowKind{"maccormack_solid", A::maccormack, kRk3, true, true},
                                           FlowKind{"bfecc", A::bfecc, kRk3, false, false}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace truestep::test
