// Reference case stab.limits: the roots of the stability polynomials, recovered by bisection on the step of a
// real field.
#include <gtest/gtest.h>

#include <cstdio>

#include "engine/integrators/table/integrators.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
namespace {

// One step is a linear map; verlet carries a third number and is judged by its growth instead.
bool holds(const Integrator& m, double stiffness, double damping, double h) {
  if (m.name == "verlet") {
    const auto field = unit_oscillator(stiffness, damping, 0.3, 1);
    SteppedField run(*field, m, h);
    run.steps(20000);
    return std::abs(run.v()) < 1e3;
  }
  const auto map = step_map(m, stiffness, damping, h);
  // Pure damping leaves the rest position free: a trivial eigenvalue 1.
  const double size = stiffness == 0 ? std::abs(map[3]) : std::abs(dominant_eigenvalue(map));
  return size <= 1 + 1e-11;
}

double largest_stable(const Integrator& m, double stiffness, double damping) {
  double low = 0.3, high = low;
  if (!holds(m, stiffness, damping, low)) return 0;
  // Steps of 1 %: some compositions lose stability over an interval of 1.4 % only.
  while (holds(m, stiffness, damping, high)) {
    low = high, high *= 1.01;
    if (high > 1e4) return HUGE_VAL;
  }
  while (high - low > 1e-5) {
    const double middle = 0.5 * (low + high);
    (holds(m, stiffness, damping, middle) ? low : high) = middle;
  }
  return low;
}

TEST(StabilityLimits, BisectionFindsWhatEveryRowPromises) {
  for (const Integrator& m : integrators()) {
    if (std::isnan(m.imaginary_limit)) continue;  // iterates a step until it converges
    const double imaginary = largest_stable(m, 1, 0);
    // A method that does not allow velocity-dependent forces has no damping limit.
    const double real = m.order_with_velocity == 0 ? m.real_limit : largest_stable(m, 0, 1);
    std::printf("%-22s imaginary %8.5f promised %8.5f   real %8.5f promised %8.5f\n",
                std::string(m.name).c_str(), imaginary, m.imaginary_limit, real, m.real_limit);
    if (std::isinf(m.imaginary_limit)) {
      EXPECT_TRUE(std::isinf(imaginary)) << m.name;
      EXPECT_TRUE(std::isinf(real)) << m.name;
    } else {
      EXPECT_NEAR(imaginary, m.imaginary_limit, 1e-3) << m.name;  // the case's own tolerance
      if (std::isinf(m.real_limit)) {
        EXPECT_TRUE(std::isinf(real)) << m.name;
      } else if (!std::isnan(m.real_limit)) {
        EXPECT_NEAR(real, m.real_limit, 1e-3) << m.name;
      }
    }
  }
}

TEST(StabilityLimits, PublishedValuesStandInTheTable) {
  EXPECT_DOUBLE_EQ(find_integrator("rk4")->imaginary_limit, 2.828427124746190097603377);
  EXPECT_DOUBLE_EQ(find_integrator("rk4")->real_limit, 2.785293563405281623529759);
  EXPECT_DOUBLE_EQ(find_integrator("dopri5")->real_limit, 3.306567892634946503721371);
  for (const char* name : {"symplectic_euler", "verlet", "velocity_verlet", "leapfrog"}) {
    EXPECT_EQ(find_integrator(name)->imaginary_limit, 2) << name;
  }
}

}  // namespace
}  // namespace truestep::test
