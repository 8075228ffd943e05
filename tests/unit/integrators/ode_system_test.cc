// What an ode system makes of its equations: structure, Jacobians, fields. (Methods, events, tracers,
// commands and faults are in tests/scenes/equations and tests/scenes/refused/equations.json.)
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/ode/ode.h"
#include "engine/systems/ode/ode_equations.h"
#include "tests/support/drawn.h"
#include "tests/support/runs/ode_run.h"

namespace truestep::test {
using namespace ode;
namespace {

const OdeModel& model_of(const OdeRun& run) {
  return static_cast<const Ode&>(run.world.system(0)).model();
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

TEST(OdeSystem, FieldsAreThePathAndEveryState) {
  OdeRun run(
      R"s("states": {"x": [1, 2], "y": [3, 4]}, "equations": {"x[i]": "0", "y[k]": "1"}, "trail": 2)s");
  run.steps(2);
  const System& s = run.world.system(0);
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

}  // namespace
}  // namespace truestep::test
