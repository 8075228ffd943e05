// Stiff springs: implicit methods hold where explicit ones cannot, and the suggested step is the true limit.
#include "tests/unit/soft/mass_spring_rig.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::SpringRun;

// Reference case stab.stiff_spring: k = 1e8, m = 1, dt = 1/60. Implicit Euler shrinks the state by
// 1 / sqrt(1 + (omega h)^2) = 0.00599989200292 per step.
MassSpringDef stiff_spring(const std::string& integrator) {
  MassSpringDef def;
  def.free = FreeShape{.points = {{0, 0, 0}, {1, 0, 0}},
                       .masses = {1, 1},
                       .springs = {{.a = 0, .b = 1, .stiffness = 1e8, .rest_length = 0.0}}};
  def.pins = {0};
  def.integrator = integrator;
  return def;
}

TEST(MassSpringStability, ImplicitEulerShrinksAStiffSpringByItsAmplification) {
  for (const char* method : {"implicit_euler", "linear_implicit_euler"}) {
    SpringRun run(stiff_spring(method), {});
    const auto size = [&] {
      const double x = run.position(1).x, v = run.velocity(1).x;
      return std::sqrt(x * x + v * v / 1e8);
    };
    for (int i = 0; i < 5; ++i) {
      const double before = size();
      run.step(1.0 / 60);
      EXPECT_NEAR(size() / before, 0.00599989200292, 1e-9) << method;
    }
  }
}

TEST(MassSpringStability, ImplicitEulerStaysBoundedForLong) {
  MassSpringDef def;
  def.rope = RopeShape{.from = {0, 0, 0}, .to = {0.1, 0, 0}, .links = 2};
  def.pinned = {"first"};
  def.mass = 1;
  def.stiffness = 1e8;
  def.integrator = "linear_implicit_euler";
  SpringRun run(def);
  run.step(1.0 / 60, 100000);
  EXPECT_LT(norm(run.position(2)), 0.11);
  // Control: an explicit method at this step does not survive ten.
  def.integrator = "symplectic_euler";
  SpringRun lost(def);
  lost.step(1.0 / 60, 10);
  EXPECT_FALSE(norm(lost.position(2)) < 0.11);
}

// The suggested step of a chain is 2 / omega_max = sqrt(m/k); its true limit lies above by
// 1 / cos(pi / 82) = 1.00073, since a chain of 41 ends has no mode quite as fast as an endless one.
TEST(MassSpringStability, SuggestedStepIsTheLimitOfAChain) {
  MassSpringDef def;
  def.rope = RopeShape{.from = {0, 0, 0}, .to = {40, 0, 0}, .links = 40};
  def.pinned = {"ends"};
  def.mass = 0.5;
  def.stiffness = 200;
  def.integrator = "symplectic_euler";
  const auto grown = [&](double factor) {
    SpringRun run(def, {});
    const double limit = run.system->limit(Limit::stable_dt, run.state, 0).value();
    EXPECT_NEAR(limit, std::sqrt(0.5 / 200), 1e-12);
    for (size_t i = 1; i < 40; ++i) run.x()[3 * i] += i % 2 == 0 ? 1e-6 : -1e-6;
    run.step(factor * limit, 4000);
    return std::abs(run.position(20).x - 20) > 1e-4 || !std::isfinite(run.position(20).x);
  };
  EXPECT_FALSE(grown(0.999));
  EXPECT_TRUE(grown(1.005));
}

}  // namespace
}  // namespace truestep
