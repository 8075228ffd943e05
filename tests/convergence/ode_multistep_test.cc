// Methods with a memory of earlier steps keep their order in a scene's system "ode", whose steps are separate
// calls.
#include <cmath>

#include "tests/convergence/problems.h"
#include "tests/support/ode_run.h"

namespace truestep::test {
namespace {

// x'' = -4 x - 0.6 x' + sin(t) from (1, 0.3), with t as a state if `extra` asks for first-order equations.
double end_of(const std::string& method, size_t steps) {
  OdeRun run(R"s("states": {"x": 1, "v": 0.3}, "equations": {"x": "v", "v": "-4 * x - 0.6 * v + sin(t)"},
    "newton_tolerance": 1e-13, "integrator": ")s" +
                 method + "\"",
             5.0 / static_cast<double>(steps));
  run.steps(static_cast<int>(steps));
  return run.value("x");
}

double order_of(const std::string& method) {
  static const double exact = [] {
    OdeRun run(R"s("states": {"x": 1, "v": 0.3}, "equations": {"x": "v", "v": "-4 * x - 0.6 * v + sin(t)"},
      "integrator": "dop853", "tolerance": 1e-14)s",
               5);
    return run.steps(1).value("x");
  }();
  return observed_order([&](size_t n) { return std::abs(end_of(method, n) - exact); }, 256, 3);
}

TEST(OdeMultistep, OrderTwoThroughTheSystem) {
  // 0.1 as for every row; about 1e-3 is left after extrapolation.
  for (const char* method : {"bdf2", "generalized_alpha", "newmark"}) {
    EXPECT_NEAR(order_of(method), 2, 0.1) << method;
  }
}

TEST(OdeMultistep, AMethodThatForgetsIsAnother) {
  // Control: a command before every step makes the method start anew. BDF2 is then TR-BDF2 in every step.
  const std::string system = R"s("states": {"x": 1, "v": 0.3}, "parameters": {"k": 4},
    "equations": {"x": "v", "v": "-k * x"}, "integrator": "bdf2")s";
  OdeRun remembers(system, 0.05), forgets(system, 0.05);
  for (int k = 0; k < 20; ++k) {
    forgets.set("k", 4);
    remembers.steps(1), forgets.steps(1);
  }
  // TR-BDF2's error constant is a quarter of BDF2's, or less.
  const double exact = std::cos(2.0) + 0.15 * std::sin(2.0);
  EXPECT_GT(std::abs(remembers.value("x") - exact), 3 * std::abs(forgets.value("x") - exact));
}

}  // namespace
}  // namespace truestep::test
