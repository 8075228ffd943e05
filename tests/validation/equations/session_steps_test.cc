// A session's step determines when the state is observed, not how it is computed: methods that rely on their
// history (CVODE's orders and steps, IAS15's predictions and the low-order parts of compensated sums) give
// the same accuracy whether an orbit is observed six times or six hundred. (How much each of these is left
// with is in tests/scenes/equations/often_observed_orbits.json.)
#include <cmath>
#include <numbers>

#include "engine/integrators/table/integrators.h"
#include "tests/support/runs/ode_run.h"

namespace truestep::test {
namespace {

// One period of a Kepler ellipse (e = 0.5, GM = 1, semi-axis 1) in `steps` session steps: distance from the
// start.
double error_after_an_orbit(const std::string& integrator, double tolerance, int steps) {
  OdeRun run(R"("states": {"x": 0.5, "y": 0}, "velocities": {"x": 0, "y": 1.7320508075688772},
    "second": {"x": "-x / (x^2 + y^2)^1.5", "y": "-y / (x^2 + y^2)^1.5"}, "integrator": ")" +
                 integrator + R"(", "tolerance": )" + write_number(tolerance),
             2 * std::numbers::pi / steps);
  run.steps(steps);
  const auto y = run.columns().f64(run.columns().at("states"));
  return std::hypot(y[0] - 0.5, y[1]);
}

// For any method: a session that observes often is not less accurate than one that observes seldom.
TEST(SessionSteps, LookingOftenCostsNoAccuracy) {
  for (const Integrator& m : integrators()) {
    if (m.stepping != Integrator::Stepping::adaptive || !m.advance) continue;
    const std::string name(m.name);
    const double tolerance = m.order < 3 ? 1e-6 : 1e-9;
    EXPECT_LT(error_after_an_orbit(name, tolerance, 628),
              3 * error_after_an_orbit(name, tolerance, 6) + 1e-13)
        << name;
  }
}

}  // namespace
}  // namespace truestep::test
