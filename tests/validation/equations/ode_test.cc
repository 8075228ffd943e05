// Reference cases ode.* as scenes: values from the IVP Test Set, DETEST and integrations in quadruple
// precision.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_run.h"

namespace truestep::test {
namespace {

const std::string kFine = R"s(, "integrator": "dop853", "tolerance": 1e-12)s";

struct Case {
  const char* name;
  std::string system;
  double dt;
  int steps;
  std::vector<std::pair<std::string, double>> expected;
  double tolerance;
};

/// The values; and as a control, changing a parameter p of every case by a thousandth misses them.
void expect(const Case& c) {
  OdeRun run(c.system + R"s(, "parameters": {"p": 1})s" + kFine, c.dt);
  run.steps(c.steps);
  for (const auto& [name, value] : c.expected) EXPECT_NEAR(run.value(name), value, c.tolerance) << c.name;
  OdeRun control(c.system + R"s(, "parameters": {"p": 1.001})s" + kFine, c.dt);
  control.steps(c.steps);
  double worst = 0;
  for (const auto& [name, value] : c.expected) worst = std::max(worst, std::abs(control.value(name) - value));
  EXPECT_GT(worst, 10 * c.tolerance) << c.name;
}

// Tolerances: about ten times what dop853 at 1e-12 leaves; those of the reference list are far wider.
TEST(OdeReference, Detest) {
  expect({"A1",
          R"s("states": {"y": 1}, "equations": {"y": "-p * y"})s",
          0.5,
          40,
          {{"y", 2.06115362243855783e-9}},
          1e-13});
  expect({"A2",
          R"s("states": {"y": 1}, "equations": {"y": "-p * y^3 / 2"})s",
          0.5,
          40,
          {{"y", 0.218217890235992381}},
          1e-10});
  expect({"A3",
          R"s("states": {"y": 1}, "equations": {"y": "p * y * cos(t)"})s",
          0.5,
          40,
          {{"y", 2.49165027185041452}},
          1e-9});
  expect({"A4",
          R"s("states": {"y": 1}, "equations": {"y": "p * y / 4 * (1 - y / 20)"})s",
          0.5,
          40,
          {{"y", 17.7301664813148398}},
          1e-9});
  expect({"A5",
          R"s("states": {"y": 4}, "equations": {"y": "p * (y - t) / (y + t)"})s",
          0.5,
          40,
          {{"y", -0.788782668896401424}},
          1e-9});
  expect(
      {"B5",
       R"s("states": {"a": 0, "b": 1, "c": 1}, "equations": {"a": "p * b * c", "b": "-a * c", "c": "-0.51 * a * b"})s",
       0.5,
       40,
       {{"a", -0.93965707987292039619}, {"b", -0.34211777540007490653}, {"c", 0.74141265961999530078}},
       1e-9});
}

TEST(OdeReference, KeplerOrbits) {
  const auto kepler = [](double e) {
    return R"s("states": {"x": )s" + write_number(1 - e) + R"s(, "y": 0, "vx": 0, "vy": )s" +
           write_number(std::sqrt((1 + e) / (1 - e))) +
           R"s(}, "let": {"w": "p * (x^2 + y^2)^-1.5"}, "equations": {"x": "vx", "y": "vy", "vx": "-w * x", "vy": "-w * y"})s";
  };
  expect({"D1", kepler(0.1), 0.5, 40, {{"x", 0.21988353520083966128}, {"vy", 0.32879779909620360826}}, 1e-8});
  expect(
      {"D3", kepler(0.5), 0.5, 40, {{"x", -0.57804329530353612328}, {"vy", -0.065049151267120901677}}, 1e-8});
  expect(
      {"D5", kepler(0.9), 0.5, 40, {{"x", -1.2952662509875743677}, {"vy", -0.12708381542786861877}}, 1e-7});
}

TEST(OdeReference, SecondOrder) {
  expect({"duffing",
          R"s("states": {"x": 1}, "second": {"x": "-x - p * x^3"})s",
          0.25,
          40,
          {{"x", 0.79887476899741432621}},
          1e-9});
  expect({"damped",
          R"s("states": {"x": 1}, "second": {"x": "-100 * p * x - 2 * x'"})s",
          0.1,
          10,
          {{"x", -0.3368516805904133628}},
          1e-9});
  expect({"henon-heiles at 10",
          R"s("states": {"q": [0.1, 0]}, "velocities": {"q": [0, 0.5]},
             "second": {"q[0]": "-q[0] - 2 * p * q[0] * q[1]", "q[1]": "-q[1] - q[0]^2 + q[1]^2"})s",
          0.5,
          20,
          {{"q.0", 0.036708919703026082557},
           {"q.1", 0.68269223990171486364},
           {"q'.1", -0.025305958813863047638}},
          1e-9});
}

TEST(OdeReference, FigureEightClosesAfterItsPeriod) {
  const std::string system = R"s("states": {"x": [-1, 1, 0], "y": [0, 0, 0]},
    "velocities": {"x": [0.34711688811892694, 0.34711688811892694, -0.69423377623785388],
                   "y": [0.53272494538803023, 0.53272494538803023, -1.06544989077606046]},
    "second": {"x[i]": "sum(j != i, (x[j] - x[i]) / ((x[j] - x[i])^2 + (y[j] - y[i])^2)^1.5)",
               "y[i]": "p * sum(j != i, (y[j] - y[i]) / ((x[j] - x[i])^2 + (y[j] - y[i])^2)^1.5)"},
    "parameters": {"p": 1}, "invariants": {
      "E": "sum(i, x'[i]^2 + y'[i]^2) / 2 - sum(i, sum(j > i, 1 / sqrt((x[j] - x[i])^2 + (y[j] - y[i])^2)))"})s";
  constexpr double kPeriod = 6.32591398292621167758900033397;
  World world(parse_scene(R"s({"schema_version": "1.0", "time": {"dt": )s" + write_number(kPeriod / 64) +
                          R"s(}, "systems": [{"type": "ode", "id": "s", )s" + system +
                          R"s(, "integrator": "dop853", "tolerance": 1e-13}]})s"));
  WorldState state = world.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const std::vector<double> start(state.systems[0].f64(0).begin(), state.systems[0].f64(0).end());
  EXPECT_NEAR(*world.observe(state).find("s.E"), -1.28714199563185770855, 1e-13);
  for (int k = 0; k < 64; ++k) world.step(state, workspace, arena, {});
  // Velocities are the second half: the orbit is closed in all of phase space.
  for (size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(state.systems[0].f64(0)[i], start[i], 1e-9);
  EXPECT_LT(*world.observe(state).find("s.E.drift"), 1e-11);
}

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
