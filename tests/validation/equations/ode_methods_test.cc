// Every method of the table that serves equations keeps its promise. (Values of the IVP Test Set and of
// DETEST are in tests/scenes/equations/reference_values.json.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "tests/support/runs/ode_run.h"

namespace truestep::test {
namespace {

const std::string kFine = R"s(, "integrator": "dop853", "tolerance": 1e-12)s";

TEST(OdeReference, EveryMethodThatServesKeepsItsPromiseOnAPendulum) {
  // x'' = -sin x from 1 to t = 2; each within what its order leaves at 200 steps, and none exact by accident.
  OdeRun reference(R"s("states": {"x": 1}, "second": {"x": "-sin(x)"})s" + kFine, 0.01);
  const double expected = reference.steps(200).value("x");
  size_t served = 0;
  for (const Integrator& m : integrators()) {
    const std::string system =
        R"s("states": {"x": 1}, "second": {"x": "-sin(x)"}, "tolerance": 1e-9, "integrator": ")s" +
        std::string(m.name) + '"';
    const auto faults = ode_faults(system);
    if (!faults.empty()) {
      EXPECT_EQ(faults[0].pointer, "/systems/0/integrator") << m.name;
      EXPECT_NE(faults[0].allowed.find("rk4"), std::string::npos);
      continue;
    }
    OdeRun run(system, 0.01);
    const double error = std::abs(run.steps(200).value("x") - expected);
    // Constants of the fixed-step methods are below 1 here; adaptive ones add up 1e-9 of every internal step.
    const bool fixed = m.stepping == Integrator::Stepping::fixed;
    EXPECT_LT(error, fixed ? std::max(std::pow(0.01, m.order), 1e-9) : 1e-6) << m.name;
    ++served;
  }
  EXPECT_GE(served, 8u);
}

}  // namespace
}  // namespace truestep::test
