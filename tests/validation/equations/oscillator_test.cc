// Reference cases ode.damped and ode.ho_amplification: textbook stability functions in closed form, computed
// to 30 digits.
#include <gtest/gtest.h>

#include "engine/integrators/table/integrators.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
using namespace oscillator;
namespace {

constexpr double kDampedX1 = -0.3368516805904133628;  // m = 1, k = 100, c = 2, x0 = 1, v0 = 0, t = 1

TEST(OscillatorReference, ExactSolutionIsThePublishedOne) {
  OscillatorDef d;
  d.stiffness = 100, d.damping = 2;
  // Four roundings of numbers near 1.
  EXPECT_NEAR(oscillator_exact(d, 1).x, kDampedX1, 1e-15);
  // Critical and overdamped motion join the underdamped one continuously.
  d.damping = 20;
  const double critical = oscillator_exact(d, 0.3).x;
  d.damping = 20 + 1e-7;
  EXPECT_NEAR(oscillator_exact(d, 0.3).x, critical, 1e-7);
  d.damping = 20 - 1e-7;
  EXPECT_NEAR(oscillator_exact(d, 0.3).x, critical, 1e-7);
}

TEST(OscillatorReference, EveryMethodFindsTheDampedMotion) {
  const auto field = unit_oscillator(100, 2, 1, 0);
  for (const Integrator& m : integrators()) {
    if (refusal(m, *field)) continue;
    // Global error: some 100 h^order; the suggested 1e-6 from order 2 on.
    const double h = m.order == 1 ? 1e-6 : m.order == 2 ? 1e-4 : 1e-3, tolerance = m.order == 1 ? 5e-5 : 1e-6;
    SteppedField run(*field, m, h, {.tolerance = 1e-9});
    run.steps(static_cast<uint64_t>(std::lround(1 / h)));
    EXPECT_NEAR(run.x(), kDampedX1, tolerance) << m.name;
  }
  // Control: 0.1 % less damping is seen.
  const auto off = unit_oscillator(100, 1.998, 1, 0);
  SteppedField run(*off, *find_integrator("rk4"), 1e-3);
  run.steps(1000);
  EXPECT_GT(std::abs(run.x() - kDampedX1), 1e-4);
}

TEST(OscillatorReference, AmplitudePerStepIsTheMethodsOwn) {
  const double h = 0.1;
  const std::pair<const char*, double> published[] = {{"euler", 1.00498756211208903},
                                                      {"implicit_euler", 0.995037190209989136},
                                                      {"linear_implicit_euler", 0.995037190209989136},
                                                      {"rk4", 0.999999993064236087},
                                                      {"heun", 1.00001249992187598},
                                                      {"midpoint", 1.00001249992187598},
                                                      {"symplectic_euler", 1},
                                                      {"velocity_verlet", 1},
                                                      {"leapfrog", 1},
                                                      {"yoshida4", 1}};
  for (const auto& [name, amplitude] : published) {
    const auto lambda = dominant_eigenvalue(step_map(*find_integrator(name), 1, 0, h));
    EXPECT_NEAR(std::abs(lambda), amplitude, 1e-12) << name;
  }
  // Numerical over true frequency.
  for (const char* name : {"velocity_verlet", "leapfrog", "symplectic_euler"}) {
    const auto lambda = dominant_eigenvalue(step_map(*find_integrator(name), 1, 0, h));
    EXPECT_NEAR(std::arg(lambda) / h, 1.00041713611540029, 1e-12) << name;
  }
  // Control: the same number is not found at another step.
  EXPECT_GT(std::abs(std::abs(dominant_eigenvalue(step_map(*find_integrator("euler"), 1, 0, 0.1001))) -
                     1.00498756211208903),
            1e-6);
}

TEST(OscillatorReference, DrivenMotionReachesItsSteadyAmplitude) {
  // F / m over sqrt((w0^2 - w^2)^2 + (c w / m)^2), textbook.
  OscillatorDef d;
  d.stiffness = 100, d.damping = 2, d.drive_force = 3, d.drive_frequency = 1.2, d.position = 0;
  const auto field = make_oscillator_field(d);
  SteppedField run(*field, *find_integrator("rk4"), 1e-3);
  run.steps(20000);
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    run.steps(1);
    most = std::max(most, std::abs(run.x()));
  }
  const double w = 2 * M_PI * 1.2;
  // The largest sample is within (w h)^2 / 8 of the peak.
  EXPECT_NEAR(most, 3 / std::hypot(100 - w * w, 2 * w), 1e-5);
}

}  // namespace
}  // namespace truestep::test
