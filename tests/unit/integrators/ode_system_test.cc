// What a scene may contain about an ode system, and the result: structure, Jacobians, events, tracers,
// commands, errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/ode/ode.h"
#include "engine/systems/ode/ode_equations.h"
#include "tests/support/drawn.h"
#include "tests/support/ode_run.h"

namespace truestep::test {
using namespace ode;
namespace {

const OdeModel& model_of(const OdeRun& run) {
  return static_cast<const Ode&>(run.world().system(0)).model();
}

TEST(OdeSystem, PairsOfEquationsAreRecognisedAsSecondOrder) {
  OdeRun kepler(R"s("states": {"x": 1, "vx": 2, "y": 3, "vy": 4}, "parameters": {"k": 1},
    "equations": {"x": "vx", "vx": "-k * x - 0.1 * vx", "y": "vy", "vy": "-k * y"})s");
  const OdeModel& m = model_of(kepler);
  EXPECT_TRUE(m.second_order);
  EXPECT_TRUE(m.depends_on_velocity);
  EXPECT_EQ(m.labels, (std::vector<std::string>{"x", "y", "vx", "vy"}));
  EXPECT_EQ(m.initial, (std::vector<double>{1, 3, 2, 4}));
  OdeRun free(R"s("states": {"x": 1, "v": 2}, "equations": {"v": "-x^3", "x": "v"})s");
  EXPECT_TRUE(model_of(free).second_order);
  EXPECT_FALSE(model_of(free).depends_on_velocity);
  EXPECT_TRUE(model_of(free).autonomous);
  OdeRun plain(R"s("states": {"x": 1, "y": 2}, "equations": {"x": "y + t", "y": "-x"})s");
  EXPECT_FALSE(model_of(plain).second_order);
  EXPECT_FALSE(model_of(plain).autonomous);
}

/// Central differences of the whole right-hand side against the compiled matrix.
void check_jacobian(const OdeModel& m) {
  OdeEquations f(m);
  f.set_parameters(m.parameter_values);
  ASSERT_TRUE(f.has_jacobian());
  const size_t n = f.size();
  const MatrixShape shape = f.jacobian_shape();
  std::vector<double> y = m.initial, values(shape.values(n), NAN), up(n), down(n);
  f.jacobian(0.3, y.data(), values.data());
  const auto entry = [&](size_t i, size_t j) -> double {
    if (shape.kind == MatrixShape::Kind::dense) return values[j * n + i];
    if (shape.kind == MatrixShape::Kind::banded) {
      if (i > j + shape.lower || j > i + shape.upper) return 0;
      return values[j * (shape.lower + shape.upper + 1) + shape.upper + i - j];
    }
    for (int32_t k = shape.column_start[j]; k < shape.column_start[j + 1]; ++k) {
      if (shape.rows[static_cast<size_t>(k)] == static_cast<int32_t>(i))
        return values[static_cast<size_t>(k)];
    }
    return 0;
  };
  for (size_t j = 0; j < n; ++j) {
    const double h = 1e-6;
    auto moved = y;
    moved[j] += h;
    f.rate(0.3, moved.data(), up.data());
    moved[j] = y[j] - h;
    f.rate(0.3, moved.data(), down.data());
    for (size_t i = 0; i < n; ++i) {
      const double difference = (up[i] - down[i]) / (2 * h);
      EXPECT_NEAR(entry(i, j), difference, 1e-6 * (1 + std::abs(difference))) << i << " " << j;
    }
  }
}

TEST(OdeSystem, JacobiansOfAllShapesAreTheLimitsOfDifferences) {
  std::string x = "0.1";
  for (int k = 1; k < 40; ++k) x += ", " + std::to_string(0.1 + 0.03 * (k % 7));
  OdeRun dense(
      R"s("states": {"x": [0.1, 0.4, 0.3]}, "equations": {"x[i]": "sin(t) * sum(j != i, x[j]^2) - exp(x[i])"
})s");
  EXPECT_EQ(model_of(dense).jacobian.kind, MatrixShape::Kind::dense);
  check_jacobian(model_of(dense));
  OdeRun banded(R"s("states": {"x": [)s" + x + R"s(]}, "equations": {"x[i]":
    "(i == 0 ? 0 : x[i - 1]) - 2 * x[i]^2 + (i == len(x) - 1 ? 0 : x[i + 1])"
  })s");
  EXPECT_EQ(model_of(banded).jacobian.kind, MatrixShape::Kind::banded);
  EXPECT_EQ(model_of(banded).jacobian.lower, 1u);
  check_jacobian(model_of(banded));
  OdeRun sparse(R"s("states": {"x": [)s" + x +
                R"s(]}, "equations": {"x[i]": "x[(i + 13) % len(x)] * x[i]"})s");
  EXPECT_EQ(model_of(sparse).jacobian.kind, MatrixShape::Kind::sparse);
  check_jacobian(model_of(sparse));
  // A chain: first order sparse, second order banded.
  OdeRun chain(R"s("states": {"x": [)s" + x + R"s(]}, "second": {"x[i]":
    "(i == 0 ? 0 : x[i - 1]) - 2 * x[i] + (i == len(x) - 1 ? 0 : x[i + 1]) - 0.2 * x'[i]"})s");
  EXPECT_EQ(model_of(chain).acceleration_jacobian.kind, MatrixShape::Kind::banded);
  check_jacobian(model_of(chain));
  OdeEquations f(model_of(chain));
  const size_t half = f.size() / 2, count = f.shape().values(half);
  std::vector<double> y = model_of(chain).initial, dadx(count), dadv(count);
  static_cast<const SecondOrder&>(f).jacobian(0, y.data(), y.data() + half, dadx.data(), dadv.data());
  EXPECT_EQ(dadx[1], -2);
  EXPECT_EQ(dadv[1], -0.2);
}

TEST(OdeSystem, StiffEquationsGetAnImplicitMethod) {
  const auto method = [](const OdeRun& run) {
    return static_cast<const Ode&>(run.world().system(0)).method();
  };
  OdeRun easy(R"s("states": {"x": 2, "v": 0}, "equations": {"x": "v", "v": "5 * (1 - x^2) * v - x"})s", 0.01);
  EXPECT_EQ(method(easy)->kind, Integrator::Kind::explicit_);
  // The second system shows its stiffness only after a moment.
  OdeRun van_der_pol(
      R"s("states": {"x": 2, "v": 0}, "equations": {"x": "v", "v": "1e5 * (1 - x^2) * v - x"})s", 0.01);
  OdeRun robertson(R"s("states": {"a": 1, "b": 0, "c": 0},
    "equations": {"a": "1e4*b*c - 0.04*a", "b": "0.04*a - 1e4*b*c - 3e7*b^2", "c": "3e7*b^2"})s",
                   0.1);
  bool implicit_exists = false;
  for (const Integrator& m : integrators()) {
    implicit_exists |=
        m.kind == Integrator::Kind::implicit && m.advance && m.stepping == Integrator::Stepping::adaptive;
  }
  const auto expected = implicit_exists ? Integrator::Kind::implicit : Integrator::Kind::explicit_;
  EXPECT_EQ(method(van_der_pol)->kind, expected);
  EXPECT_EQ(method(robertson)->kind, expected);
  // Fast oscillations are no reason for an implicit method, which would have to follow them too.
  OdeRun fast(R"s("states": {"x": 1, "v": 0}, "equations": {"x": "v", "v": "-1e8 * x"})s", 0.1);
  EXPECT_EQ(method(fast)->kind, Integrator::Kind::explicit_);
}

TEST(OdeEvents, BouncesAreLocatedToTheLastDigits) {
  const std::string ball = R"s("states": {"h": 1, "v": 0}, "parameters": {"g": 9.81, "e": 0.8},
    "equations": {"h": "v", "v": "-g"}, "integrator": "dopri5", "tolerance": 1e-10,
    "events": [{"name": "bounce", "when": "h", "direction": ")s";
  OdeRun run(ball + R"s(falling", "set": {"v": "-e * v"}}])s");
  const double fall = std::sqrt(2 / 9.81);
  run.steps(30);
  EXPECT_EQ(run.value("events.bounce"), 6);
  double t = fall, v = 9.81 * fall;
  for (int k = 0; k < 6; ++k) {
    v *= 0.8;
    if (t + 2 * v / 9.81 <= 3) t += 2 * v / 9.81;
  }
  const double left = 3 - t;
  EXPECT_NEAR(run.value("h"), v * left - 0.5 * 9.81 * left * left, 1e-10);
  // Control: nothing rises through the floor.
  OdeRun other(ball + R"s(rising", "set": {"v": "-e * v"}}])s");
  other.steps(5);
  EXPECT_EQ(other.value("events.bounce"), 0);
  EXPECT_LT(other.value("h"), 0);
}

TEST(OdeEvents, TimesPeriodsAndStops) {
  OdeRun run(R"s("states": {"x": 0, "n": 0}, "parameters": {"rate": 1}, "equations": {"x": "rate", "n": "0"},
    "integrator": "rk4", "events": [
      {"name": "tick", "every": 0.25, "set": {"n": "n + 1"}},
      {"name": "turn", "at": 0.83, "set": {"rate": "-2"}},
      {"name": "edge", "at": 1.0},
      {"name": "end", "when": "x + 0.5", "then": "stop"}])s");
  run.steps(10);
  EXPECT_EQ(run.value("stopped"), 0);
  EXPECT_EQ(run.value("stopped.time"), static_cast<double>(run.state.step) * run.world().dt());
  const auto known = run.world().known_observables();
  EXPECT_TRUE(std::ranges::any_of(known, [](const Observation& o) { return o.name == "s.stopped.time"; }));
  EXPECT_EQ(run.value("events.tick"), 4);  // 0.25, 0.5, 0.75 and 1.0, the end of the tenth step
  EXPECT_EQ(run.value("n"), 4);
  EXPECT_EQ(run.value("events.edge"), 1);
  EXPECT_NEAR(run.value("x"), 0.83 - 2 * 0.17, 1e-12);
  run.steps(20);
  EXPECT_EQ(run.value("stopped"), 1);
  EXPECT_NEAR(run.value("stopped.time"), 0.83 + 1.33 / 2, 1e-12);
  EXPECT_NEAR(run.value("x"), -0.5, 1e-12);
  EXPECT_EQ(run.value("events.edge"), 1);
  run.set("rate", 1);
  run.steps(1);
  EXPECT_NEAR(run.value("x"), -0.4, 1e-12);
}

TEST(OdeEvents, APileUpIsAnInstability) {
  OdeRun zeno(
      R"s("states": {"h": 0.1, "v": 0}, "equations": {"h": "v", "v": "-9.81"}, "integrator": "dopri5",
    "events": [{"name": "bounce", "when": "h", "direction": "falling", "set": {"h": "1e-9", "v": "-0.5"}}])s");
  try {
    zeno.steps(20);
    ADD_FAILURE();
  } catch (const Instability& e) {
    EXPECT_EQ(e.system, "s");
    EXPECT_NE(std::string(e.what()).find("pile up"), std::string::npos);
  }
}

TEST(OdeTracers, FollowARotationAndTheStatesOfTheSystem) {
  // The field rotates about a centre that is itself a state of the system.
  OdeRun run(R"s("states": {"c": 0}, "equations": {"c": "1"}, "integrator": "rk4",
    "tracers": {"velocity": {"x": "1 - y", "y": "x - c"}, "points": [[1, 0, 0], [0, 2, 0.5]]})s",
             0.01);
  run.steps(100);
  const auto x = run.columns().f64(OdeColumns::kTracers);
  EXPECT_NEAR(x[0], 1 + std::cos(1.0), 1e-9);
  EXPECT_NEAR(x[1], std::sin(1.0), 1e-9);
  EXPECT_NEAR(x[3], 1 - 2 * std::sin(1.0), 1e-9);
  EXPECT_EQ(x[5], 0.5);
  // Control: a centre at rest leads elsewhere.
  OdeRun still(R"s("states": {"c": 0}, "equations": {"c": "0"}, "integrator": "rk4",
    "tracers": {"velocity": {"x": "1 - y", "y": "x - c"}, "points": [[1, 0, 0]]})s",
               0.01);
  still.steps(100);
  EXPECT_GT(std::abs(still.columns().f64(OdeColumns::kTracers)[1] - std::sin(1.0)), 0.1);
}

TEST(OdeSystem, FieldsAreThePathAndEveryState) {
  OdeRun run(
      R"s("states": {"x": [1, 2], "y": [3, 4]}, "equations": {"x[i]": "0", "y[k]": "1"}, "trail": 2)s");
  run.steps(2);
  const System& s = run.world().system(0);
  ASSERT_EQ(s.parts().size(), 2u);
  EXPECT_EQ(s.parts()[0].fields[0].name, "position");
  EXPECT_EQ(s.parts()[1].fields.size(), 2u);
  std::vector<double> scratch;
  const FieldView path = s.field(run.columns(), 0, 0, scratch);
  ASSERT_EQ(path.rows, 6u);
  const auto* p = static_cast<const double*>(path.data);
  EXPECT_NEAR(p[1], 3.2, 1e-9);
  EXPECT_NEAR(p[4], 3.1, 1e-9);
  EXPECT_EQ(p[7], 3);
  EXPECT_EQ(p[9], 2);
  EXPECT_EQ(testing::drawn(s, run.columns()).parts[0].lines.size(), 4u);
  const FieldView y = s.field(run.columns(), 1, 1, scratch);
  EXPECT_EQ(y.rows, 2u);
  EXPECT_NEAR(static_cast<const double*>(y.data)[1], 4.2, 1e-9);
}

TEST(OdeSystem, CommandsSetParametersAndStates) {
  OdeRun run(R"s("states": {"x": 0, "a": [1, 2]}, "parameters": {"mu": 1, "m": [1, 2]},
    "equations": {"x": "mu + m[1]", "a[i]": "0"})s");
  run.set("mu", -2);
  run.set("a[1]", 7);
  run.steps(10);
  EXPECT_NEAR(run.value("x"), 0, 1e-12);
  EXPECT_EQ(run.value("a.1"), 7);
  for (const char* bad : {"nu", "m", "m[2]", "a[-1]", "mu[0]", "a[1", "", "a[1]x"}) {
    EXPECT_THROW(run.set(bad, 1), Error) << bad;
  }
  EXPECT_THROW(run.set("mu", NAN), Error);
  try {
    run.set("muu", 1);
  } catch (const Error& e) {
    EXPECT_EQ(e.issues()[0].did_you_mean, "mu");
  }
}

TEST(OdeSystem, AllFaultsAtOnceWithPointers) {
  const auto faults =
      ode_faults(R"s("states": {"x": 1, "y": 2, "v": [1, 2], "sin": 1}, "parameters": {"x": 1, "mu": 5},
    "let": {"r": "sqrt(x^2 + q)", "k[1]": "2"}, "equations": {"x": "nu * y", "v": "1", "w": "2", "y": "1 +"},
    "invariants": {"E": "x(2)"}, "absolute_tolerances": {"z": 1e-3},
    "events": [{"when": "yy", "set": {"muu": "1"}}], "plot": ["x", "cosine(y)"])s");
  const auto found = [&](const std::string& pointer) -> const Issue* {
    for (const Issue& i : faults) {
      if (i.pointer == "/systems/0" + pointer) return &i;
    }
    return nullptr;
  };
  for (const char* pointer : {"/states/sin", "/parameters/x", "/let/r", "/let/k[1]", "/equations/x",
                              "/equations/v", "/equations/w", "/equations/y", "/equations", "/invariants/E",
                              "/absolute_tolerances/z", "/events/0/when", "/events/0/set/muu", "/plot/1"}) {
    // A name shared by a parameter and a state is refused where it occurs second.
    if (std::string(pointer) == "/parameters/x") {
      EXPECT_TRUE(found("/states/x"));
    } else {
      EXPECT_TRUE(found(pointer)) << pointer;
    }
  }
  EXPECT_EQ(found("/equations/x")->did_you_mean, "mu");
  EXPECT_NE(found("/equations/x")->message.find(">>>nu"), std::string::npos)
      << found("/equations/x")->message;
  EXPECT_NE(found("/equations")->message.find("v[0]"), std::string::npos);
}

TEST(OdeSystem, WhatExpandsWithoutBoundIsRefused) {
  EXPECT_FALSE(
      ode_faults(R"s("states": {"x": 1}, "equations": {"x": "sum(i, 1, 3000, sum(j, 1, 3000, x * i * j))"})s")
          .empty());
  EXPECT_FALSE(ode_faults(R"s("states": {"x": 1}, "equations": {"x": "x"}, "let": {"x": "1"})s").empty());
  EXPECT_FALSE(ode_faults(R"s("equations": {"x": "x"})s").empty());
  EXPECT_FALSE(
      ode_faults(R"s("states": {"x": 1}, "equations": {"x": "x"}, "tracers": {"velocity": {"x": "1"}})s")
          .empty());
}

TEST(OdeSystem, ANonFiniteStateNamesItself) {
  OdeRun run(
      R"s("states": {"calm": 1, "wild": 1}, "equations": {"calm": "0", "wild": "wild^2"}, "integrator": "rk4")s");
  try {
    run.steps(100);
    ADD_FAILURE();
  } catch (const Instability& e) {
    EXPECT_EQ(e.quantity, "wild");
    EXPECT_EQ(e.system, "s");
  }
}

}  // namespace
}  // namespace truestep::test
