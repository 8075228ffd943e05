// Flows that no longer change, found directly: the cavity against its spectral columns, against the same flow
// stepped to its end, and against Kovasznay's flow.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/cavity.h"
#include "tests/support/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

TEST(GridFluidSteady, CavityAtReynolds1000IsTheSpectralOneOfFourthOrder) {
  using Order = GridFluidDef::Order;
  double rms[2][3] = {};
  for (const Order order : {Order::second, Order::fourth}) {
    for (int k = 0; k < 3; ++k) {
      GridFlow run(steady_cavity(int64_t{32} << k, order), 1);
      run.steps(1);
      rms[order == Order::fourth][k] = cavity_rms(run);
      std::printf("  order %d, %d cells: rms %.5f, %.0f iterations, change %.1e, divergence %.1e\n",
                  order == Order::fourth ? 4 : 2, 32 << k, cavity_rms(run), run.observed("steady.iterations"),
                  run.observed("steady.change"), run.observed("divergence.max"));
      EXPECT_LT(run.observed("divergence.max"), 1e-10);
    }
  }
  EXPECT_LT(rms[1][2], 0.0019);
  EXPECT_GT(rms[0][2], 0.0019);
}

}  // namespace
}  // namespace truestep::test
