// Heat and waves give the same bits for any number of threads, with a workspace that is discarded, with
// another state in between, and from a restored snapshot.
#include <gtest/gtest.h>

#include "tests/support/fluids/field_run.h"

namespace truestep::test {
namespace {

constexpr uint64_t kSteps = 4;

struct Kind {
  const char *name, *integrator, *coefficient;
  enum class Of : uint8_t { heat, wave } of;
  double dt;
};

std::unique_ptr<FieldRun> make(const Kind& k, int threads) {
  const auto fill = [&](auto& d) {
    // Enough rows for several blocks of every loop.
    d.cells = {40, 260};
    d.integrator = k.integrator;
    d.initial = "exp(-50*((x - 0.4)^2 + (y - 0.6)^2))";
    d.source = "x*sin(9*t)";
    d.sides.x_min = side(lattice::SideKind::dirichlet, "0.1*sin(5*t)");
    d.sides.x_max = side(lattice::SideKind::robin, "y", 2);
    d.sides.y_min = side(lattice::SideKind::neumann, "x*t");
    d.tolerance = 1e-2;
  };
  if (k.of == Kind::Of::heat) {
    heat::HeatDef d;
    fill(d);
    d.diffusivity = k.coefficient;
    return std::make_unique<FieldRun>(d, k.dt, threads);
  }
  wave::WaveDef d;
  fill(d);
  d.speed = k.coefficient;
  return std::make_unique<FieldRun>(d, k.dt, threads);
}

class FieldBits : public ::testing::TestWithParam<Kind> {};

TEST_P(FieldBits, DoNotDependOnHowTheRunIsMade) {
  const auto reference = make(GetParam(), 0);
  std::vector<std::byte> snapshot;
  for (uint64_t n = 0; n < kSteps; ++n) {
    if (n == kSteps / 2) snapshot = reference->state.serialize();
    reference->steps(1);
  }
  const uint64_t hash = reference->state.hash();
  ASSERT_NE(hash, reference->system->initial_state().hash());
  for (const int threads : {1, 2, 8}) {
    const auto run = make(GetParam(), threads);
    run->steps(kSteps);
    EXPECT_EQ(run->state.hash(), hash) << threads << " threads";
  }
  {
    const auto run = make(GetParam(), 1);
    for (uint64_t n = 0; n < kSteps; ++n) run->workspace.clear(), run->steps(1);
    EXPECT_EQ(run->state.hash(), hash) << "workspace dropped";
  }
  {
    const auto run = make(GetParam(), 1);
    State other = run->state;
    other.f64(0)[1000] += 0.5;
    for (uint64_t n = 0; n < kSteps; ++n) {
      run->steps(1);
      std::swap(run->state, other);
      --run->done();
      run->steps(1);
      std::swap(run->state, other);
    }
    EXPECT_EQ(run->state.hash(), hash) << "another state in between";
    EXPECT_NE(other.hash(), hash);
  }
  {
    const auto run = make(GetParam(), 1);
    run->state = State::deserialize(snapshot);
    run->done() = kSteps / 2;
    run->steps(kSteps - kSteps / 2);
    EXPECT_EQ(run->state.hash(), hash) << "restored";
  }
}

using Of = Kind::Of;
INSTANTIATE_TEST_SUITE_P(Fields, FieldBits,
                         ::testing::Values(Kind{"heat_euler", "euler", "1", Of::heat, 2e-5},
                                           Kind{"heat_rk4", "rk4", "1 + x*y", Of::heat, 2e-5},
                                           Kind{"heat_rkc2", "rkc2", "1 + 0.2*sin(t)", Of::heat, 1e-3},
                                           Kind{"heat_sdirk4", "sdirk4", "1", Of::heat, 2e-3},
                                           Kind{"heat_radau5", "radau5", "1 + x*y", Of::heat, 1e-2},
                                           Kind{"heat_bdf2", "bdf2", "1 + x*y", Of::heat, 1e-2},
                                           Kind{"wave_leapfrog", "leapfrog", "1", Of::wave, 2e-3},
                                           Kind{"wave_midpoint", "implicit_midpoint", "1 + 0.2*x", Of::wave,
                                                5e-2},
                                           Kind{"wave_alpha", "generalized_alpha", "1", Of::wave, 5e-2},
                                           Kind{"wave_dop853", "dop853", "1", Of::wave, 5e-2}),
                         [](const auto& info) { return info.param.name; });

TEST(FieldBits, EulerInPlaceIsEuler) {
  // Without forcing, one thread steps in place and several threads into a second array.
  for (const auto order : {lattice::LatticeDef::Order::second, lattice::LatticeDef::Order::fourth}) {
    for (const lattice::SideKind kind :
         {lattice::SideKind::dirichlet, lattice::SideKind::neumann, lattice::SideKind::periodic}) {
      for (const size_t dimensions : {1, 2, 3}) {
        heat::HeatDef d;
        d.cells = {12, 300, 7};
        d.cells.resize(dimensions);
        d.order = order;
        d.integrator = "euler";
        d.all = side(kind);
        d.initial = "x*(1 - x)";
        if (dimensions > 1) d.initial += "*exp(y)";
        FieldRun one(d, 1e-7, 1), two(d, 1e-7, 2);
        one.steps(20), two.steps(20);
        EXPECT_EQ(one.state.hash(), two.state.hash()) << dimensions;
        EXPECT_NE(one.state.hash(), one.system->initial_state().hash());
      }
    }
  }
}

}  // namespace
}  // namespace truestep::test
