// A flow that no number of substeps can follow is refused with a step that works.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

TEST(GridFluidStability, StepsBeyondAllSubstepsAreRefusedWithOneThatWorks) {
  GridFluidDef d;
  d.cells = {32, 32};
  d.viscosity = 1e-3;
  d.sides.y_max = FlowSideDef{SideKind::wall, {"1", "0"}};
  d.initial = {"1e6*sin(pi*x)^2*sin(2*pi*y)", "-1e6*sin(2*pi*x)*sin(pi*y)^2"};
  GridFlow run(d, 1);
  try {
    run.steps(1);
    FAIL() << "a million cells in a step";
  } catch (const Instability& e) {
    ASSERT_GT(e.suggested_dt, 0);
    GridFlow shorter(d, e.suggested_dt);
    shorter.steps(1);
    EXPECT_TRUE(std::isfinite(shorter.observed("energy.kinetic")));
  }
}

}  // namespace
}  // namespace truestep::test
