// A session's step determines when the state is observed, not how it is computed: methods that rely on their
// history (CVODE's orders and steps, IAS15's predictions and the low-order parts of compensated sums) give
// the same accuracy whether an orbit is observed six times or six hundred.
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

TEST(SessionSteps, CvodeKeepsItsHistory) {
  for (const char* method : {"cvode_adams", "cvode_bdf"}) {
    const double seldom = error_after_an_orbit(method, 1e-8, 6);
    const double often = error_after_an_orbit(method, 1e-8, 628);
    EXPECT_LT(often, 3 * seldom) << method;
    EXPECT_LT(often, 1e-4) << method;
  }
}

// The position at the end is known to some roundings times the orbit's own stretching of errors (3 pi).
TEST(SessionSteps, CompensatedMethodsKeepTheirSums) {
  for (const char* method : {"ias15", "rkn1210", "dop853"}) {
    const double seldom = error_after_an_orbit(method, 1e-13, 6);
    const double often = error_after_an_orbit(method, 1e-13, 628);
    EXPECT_LT(often, std::max(3 * seldom, 1e-14)) << method;
  }
  for (const int steps : {6, 62, 628, 6283})
    EXPECT_LT(error_after_an_orbit("ias15", 1e-13, steps), 1e-13) << steps;
  // Control: a method of order 5 does not get there.
  EXPECT_GT(error_after_an_orbit("tsit5", 1e-13, 628), 1e-13);
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
