// Symplectic rows keep the energy error bounded for as long as the run lasts (Hairer, Lubich, Wanner 2006,
// theorem IX.8.1); the others drift, which is the control.
#include <gtest/gtest.h>

#include <cstdio>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/pendulum/pendulum.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
using namespace pendulum;
namespace {

struct Drift {
  double early, late;  // largest relative energy error of the first and the last tenth
};

Drift drift(const ForceField& field, const Integrator& m, double h, uint64_t steps) {
  SteppedField run(field, m, h, kOneInternalStep);
  const double before = run.energy();
  Drift d{0, 0};
  for (uint64_t i = 0; i < steps; ++i) {
    run.steps(1);
    const double error = std::abs(run.energy() - before) / std::abs(before);
    if (i < steps / 10) d.early = std::max(d.early, error);
    if (i >= steps - steps / 10) d.late = std::max(d.late, error);
    if (!(error < 1e6)) return {d.early, HUGE_VAL};
  }
  return d;
}

TEST(Energy, SymplecticRowsStayBoundedOver100000Steps) {
  const auto spring = unit_oscillator(1, 0, 1, 0.2);
  PendulumDef d;
  d.angle = 1.2;
  const PendulumField pendulum(d, {0, -9.81, 0});
  const std::pair<const ForceField*, double> cases[] = {{spring.get(), 0.1}, {&pendulum, 0.02}};
  for (const auto& [field, h] : cases) {
    for (const Integrator& m : integrators()) {
      if (m.structure != Integrator::Structure::symplectic) continue;
      const Drift e = drift(*field, m, h, 100000);
      std::printf("%-18s energy error early %.2e late %.2e\n", std::string(m.name).c_str(), e.early, e.late);
      // Bounded: the last tenth is no worse than the first, except for sampling and 1e5 roundings.
      EXPECT_LT(e.late, 1.05 * e.early + 1e-10) << m.name;
    }
  }
}

TEST(Energy, OtherRowsDrift) {
  const auto spring = unit_oscillator(1, 0, 1, 0.2);
  for (const char* name : {"euler", "modified_euler", "midpoint", "heun", "rk4"}) {
    const Drift e = drift(*spring, *find_integrator(name), 0.1, 100000);
    EXPECT_GT(e.late, 1.05 * e.early + 1e-10) << name;
  }
}

}  // namespace
}  // namespace truestep::test
