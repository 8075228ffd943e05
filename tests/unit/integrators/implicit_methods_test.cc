// Requirements on implicit methods besides accuracy: dense output between accepted steps, stopping where a
// watcher demands it, the same bits when a run is split with its carry and memory, derivatives by
// differences, and errors that say where it failed.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/stiff_problems.h"

namespace truestep::test {
namespace {

constexpr const char* kAdaptive[] = {"tr_bdf2", "sdirk4", "rodas5p", "radau5", "cvode_bdf", "cvode_adams"};
constexpr const char* kFixed[] = {"implicit_midpoint", "trapezoid", "bdf2", "newmark", "generalized_alpha"};
constexpr const char* kFirstOrder[] = {"implicit_euler", "linear_implicit_euler"};

// x'' = -x - 0.1 (x + x^3 - c(t)) with the forcing that makes x = sin t the solution.
class Forced final : public RightHandSide, public SecondOrder {
 public:
  size_t size() const override { return 2; }
  const SecondOrder* second_order() const override { return this; }
  bool depends_on_velocity() const override { return false; }
  void rate(double t, const double* y, double* d) const override {
    d[0] = y[1];
    acceleration(t, y, y + 1, d + 1);
  }
  void acceleration(double t, const double* x, const double*, double* a) const override {
    const double s = trig::sin(t);
    a[0] = -x[0] - 0.1 * (x[0] + x[0] * x[0] * x[0] - s - s * s * s);
  }
};

struct Between final : StepWatcher {
  double stop_at = HUGE_VAL, worst_inside = 0, worst_ends = 0;
  size_t steps = 0;
  Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) override {
    ++steps;
    double y[2];
    for (const double theta : {0.2, 0.5, 0.9}) {
      between.at(theta, y);
      const double t = t0 + theta * (t1 - t0);
      worst_inside = std::max({worst_inside, std::abs(y[0] - std::sin(t)), std::abs(y[1] - std::cos(t))});
    }
    between.at(1, y);
    worst_ends = std::max({worst_ends, std::abs(y[0] - y1[0]), std::abs(y[1] - y1[1])});
    return t1 >= stop_at ? Verdict::stop : Verdict::go_on;
  }
};

struct Start {
  std::vector<double> y = {0, 1};
  Carry carry;
  std::vector<double> memory;
  Workspace workspace;
  double reached = 0;
};

void go(const char* method, const RightHandSide& f, Start& s, double t, double t_end, double tolerance,
        uint64_t fixed_steps, StepWatcher* watcher = nullptr) {
  Advance a{.f = f,
            .t = t,
            .t_end = t_end,
            .y = s.y.data(),
            .workspace = s.workspace,
            .carry = s.carry,
            .tolerance = {.relative = tolerance, .absolute = tolerance},
            .fixed_steps = fixed_steps,
            .memory = s.memory,
            .watcher = watcher};
  find_integrator(method)->advance(a);
  s.reached = a.reached;
}

TEST(ImplicitMethods, DenseOutputIsAsGoodAsTheSteps) {
  const Forced f;
  for (const char* method : kAdaptive) {
    Start s;
    Between between;
    go(method, f, s, 0, 3, 1e-7, 1, &between);
    const double end = std::max(std::abs(s.y[0] - std::sin(3.0)), std::abs(s.y[1] - std::cos(3.0)));
    EXPECT_LT(end, 1e-4) << method;
    EXPECT_GT(between.steps, 3u) << method;
    // Interpolants of order 3 or more: a few times the error at the ends, never that of a straight line (the
    // control: steps are 0.01 s and longer, a line would be off by 1e-5).
    EXPECT_LT(between.worst_inside, 10 * end + 3e-6) << method;
    EXPECT_LT(between.worst_ends, 1e-13) << method;
  }
  for (const char* method : kFixed) {
    Start s;
    Between between;
    go(method, f, s, 0, 3, 1e-7, 300, &between);
    EXPECT_EQ(between.steps, 300u) << method;
    // Order 2 with h = 0.01.
    EXPECT_LT(between.worst_inside, 1e-4) << method;
    EXPECT_LT(between.worst_ends, 1e-13) << method;
  }
  for (const char* method : kFirstOrder) {
    Start s;
    Between between;
    go(method, f, s, 0, 3, 1e-7, 300, &between);
    EXPECT_EQ(between.steps, 300u) << method;
    // A step of h = 0.01 s damps by h^2 / 2: amplitudes by 0.015 after 3 s; explicit Euler would gain as
    // much.
    EXPECT_LT(between.worst_inside, 0.02) << method;
    EXPECT_GT(between.worst_inside, 1e-3) << method;
    EXPECT_LT(between.worst_ends, 1e-13) << method;
  }
}

TEST(ImplicitMethods, StopWhereAWatcherSays) {
  const Forced f;
  for (const char* method : kAdaptive) {
    Start s;
    Between between;
    between.stop_at = 1;
    go(method, f, s, 0, 3, 1e-6, 1, &between);
    EXPECT_GE(s.reached, 1) << method;
    EXPECT_LT(s.reached, 3) << method;
    EXPECT_NEAR(s.y[0], std::sin(s.reached), 1e-3) << method;
  }
  for (const char* method : kFixed) {
    Start s;
    Between between;
    between.stop_at = 0.995;
    go(method, f, s, 0, 3, 1e-6, 300, &between);
    EXPECT_NEAR(s.reached, 1, 0.0101) << method;
    EXPECT_NEAR(s.y[0], std::sin(s.reached), 1e-3) << method;
  }
  for (const char* method : kFirstOrder) {
    Start s;
    Between between;
    between.stop_at = 0.995;
    go(method, f, s, 0, 3, 1e-6, 300, &between);
    EXPECT_NEAR(s.reached, 1, 0.0101) << method;
    EXPECT_NEAR(s.y[0], std::sin(s.reached), 0.01) << method;
  }
}

TEST(ImplicitMethods, CarryAndMemoryAreAllThatARestoredRunNeeds) {
  const Forced f;
  const auto memory_of = [](const std::string& method) {
    return std::vector<double>(method == "bdf2" ? 5 : method == "generalized_alpha" ? 3 : 0, NAN);
  };
  const auto run = [&](const char* method, bool forget) {
    Start s;
    s.memory = memory_of(method);
    for (int k = 0; k < 6; ++k) {
      if (forget) s.workspace.clear();
      go(method, f, s, 0.5 * k, 0.5 * (k + 1), 1e-6, 3);
    }
    return s.y;
  };
  for (const auto& methods : {std::span<const char* const>(kAdaptive), std::span<const char* const>(kFixed),
                              std::span<const char* const>(kFirstOrder)}) {
    for (const char* method : methods) EXPECT_EQ(run(method, false), run(method, true)) << method;
  }
  // Control: the memory matters in methods that have one.
  for (const char* method : {"bdf2", "generalized_alpha"}) {
    Start without;
    for (int k = 0; k < 6; ++k) go(method, f, without, 0.5 * k, 0.5 * (k + 1), 1e-6, 3);
    EXPECT_NE(without.y, run(method, false)) << method;
  }
}

// HIRES without its derivatives.
class Plain final : public RightHandSide {
 public:
  size_t size() const override { return 8; }
  void rate(double t, const double* y, double* d) const override { hires_.rate(t, y, d); }

 private:
  Hires hires_;
};

TEST(ImplicitMethods, DifferencesDoWhereDerivativesAreMissing) {
  const StiffCase at = Hires::published();
  for (const char* method : {"sdirk4", "rodas5p", "radau5", "cvode_bdf"}) {
    Start s;
    s.y = at.y0;
    Plain f;
    Advance a{.f = f,
              .t = 0,
              .t_end = at.t_end,
              .y = s.y.data(),
              .workspace = s.workspace,
              .carry = s.carry,
              .tolerance = {.relative = 1e-8, .absolute = 1e-12}};
    Statistics count;
    a.statistics = &count;
    find_integrator(method)->advance(a);
    EXPECT_LT(at.error(s.y.data()), 1e-6) << method;
    EXPECT_GT(count.steps, 50u) << method;
    EXPECT_GT(count.jacobians, 0u) << method;
    EXPECT_GT(count.factorisations, 0u) << method;
  }
}

// y' = y^2 from 1 diverges at t = 1.
class Explosion final : public RightHandSide {
 public:
  size_t size() const override { return 1; }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override { d[0] = y[0] * y[0]; }
};

TEST(ImplicitMethods, GiveUpWithAReason) {
  for (const char* method : kAdaptive) {
    Start s;
    s.y = {1};
    try {
      go(method, Explosion(), s, 0, 2, 1e-6, 1);
      ADD_FAILURE() << method << " stepped over a pole";
    } catch (const Instability& e) {
      EXPECT_EQ(e.index, 0) << method;
      EXPECT_NE(std::string(e.what()).find("t = "), std::string::npos) << method << ": " << e.what();
    }
  }
  Start s;
  s.y = {1};
  EXPECT_THROW(go("newmark", Explosion(), s, 0, 2, 1e-6, 10), Error);
}

// y' = -40 atan(10 y): nearly linear at the start, steep at the end. With the Jacobian of the start, the
// iterations of a long step diverge from its solution; a fixed step cannot fall back on a shorter one.
class Bend final : public RightHandSide {
 public:
  size_t size() const override { return 1; }
  void rate(double, const double* y, double* d) const override { d[0] = -40 * trig::atan(10 * y[0]); }
};

TEST(ImplicitMethods, AFixedStepIsSolvedWhereTheStartsJacobianLeadsAway) {
  const Bend f;
  Start s;
  s.y = {3};
  go("implicit_midpoint", f, s, 0, 0.1, 1e-6, 1);
  // The stage: Y + 0.05 * 40 atan(10 Y) = 3, and y1 = 2 Y - 3.
  const double stage = 0.5 * (s.y[0] + 3);
  EXPECT_NEAR(stage + 2 * std::atan(10 * stage), 3, 1e-9);
  // Control: simplified iterations from there contract by |1 - F'(Y) / F'(3)| > 1.
  const auto slope = [](double y) { return 1 + 20 / (1 + 100 * y * y); };
  EXPECT_GT(std::abs(1 - slope(stage) / slope(3)), 1);
}

}  // namespace
}  // namespace truestep::test
