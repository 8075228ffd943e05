// Reference case stab.stiff_spring: k = 1e8 N/m, m = 1 kg, dt = 1/60 s. Implicit Euler shrinks the amplitude
// by 1 / sqrt(1 + (w h)^2) per step, explicit methods need dt <= 2e-4.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
using namespace oscillator;
namespace {

constexpr double kStiffness = 1e8, kStep = 1.0 / 60;

TEST(StiffSpring, ImplicitEulerHasItsClosedFormAmplitudeAndStaysBounded) {
  for (const char* name : {"implicit_euler", "linear_implicit_euler"}) {
    const Integrator& m = *find_integrator(name);
    // 13 digits are published.
    EXPECT_NEAR(std::abs(dominant_eigenvalue(step_map(m, kStiffness, 0, kStep))), 0.00599989200292, 1e-13)
        << name;
    const auto field = unit_oscillator(kStiffness, 0, 1, 0);
    SteppedField run(*field, m, kStep);
    const double before = run.energy();
    for (int i = 0; i < 100; ++i) {
      run.steps(1000);
      ASSERT_LE(run.energy(), before) << name;
    }
  }
}

TEST(StiffSpring, ExplicitMethodsFailThereAndSayWhichStepWouldHold) {
  OscillatorDef d;
  d.stiffness = kStiffness;
  for (const char* name : {"symplectic_euler", "velocity_verlet", "leapfrog", "rk4"}) {
    d.integrator = name;
    const auto system = make_oscillator(&d, {});
    const auto dt = system->limit(Limit::stable_dt, system->initial_state(), 0);
    ASSERT_TRUE(dt) << name;
    EXPECT_NEAR(*dt, find_integrator(name)->imaginary_limit * 1e-4, 1e-12) << name;
    const auto field = make_oscillator_field(d);
    SteppedField held(*field, *find_integrator(name), 0.99 * *dt);
    held.steps(100000);
    EXPECT_LT(std::abs(held.x()), 20) << name;
    SteppedField broken(*field, *find_integrator(name), kStep);
    broken.steps(1000);
    EXPECT_FALSE(std::abs(broken.x()) < 1e10) << name;
  }
  // Unconditionally stable and adaptive methods have no such limit.
  for (const char* name : {"implicit_euler", "dopri5", "step_doubling"}) {
    d.integrator = name;
    const auto system = make_oscillator(&d, {});
    EXPECT_FALSE(system->limit(Limit::stable_dt, system->initial_state(), 0)) << name;
  }
}

TEST(StiffSpring, AdaptiveMethodsDivideTheStep) {
  for (const char* name : {"dopri5", "step_doubling"}) {
    const auto field = unit_oscillator(kStiffness, 0, 1, 0);
    // In m and in m/s alike; velocities reach 1e4 m/s here.
    SteppedField run(*field, *find_integrator(name), kStep, {.tolerance = 1e-3, .relative_tolerance = 0});
    run.steps(60);
    EXPECT_LT(run.state.f64(run.state.at("integrator.internal_step"))[0], 2e-4) << name;
    // The error is the root mean square over position and velocity: one of them alone may use sqrt 2 of the
    // tolerance.
    EXPECT_NEAR(run.energy(), 0.5e8, 1e-3 * std::numbers::sqrt2 * 0.5e8) << name;
  }
}

TEST(StiffSpring, AToleranceThatNobodyCanMeetIsAnInstabilityWithItsReason) {
  const auto field = unit_oscillator(1, 0, 1, 0);
  SteppedField run(*field, *find_integrator("dopri5"), 1, {.tolerance = 1e-300});
  EXPECT_THROW(run.steps(1), Instability);
}

}  // namespace
}  // namespace truestep::test
