// Properties of every method in the table's `advance` column: its order on Kepler's orbit, the same end as
// its step function on force fields, dense output of the promised order, events of a failing run, and a run
// that can be repeated from its carry alone.
#include "engine/integrators/advance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_problems.h"

namespace truestep::test {
namespace {

bool explicit_row(const Integrator& m) {
  return m.advance && m.kind == Integrator::Kind::explicit_ && !m.name.starts_with("cvode");
}

// n internal steps of equal length over [0, t_end], adaptive methods by calls that allow one step each.
std::vector<double> equal_steps(const Integrator& m, const RightHandSide& f, std::vector<double> y,
                                double t_end, size_t n) {
  Workspace workspace;
  const double h = t_end / double(n);
  for (size_t i = 0; i < n; ++i) {
    Carry carry{.step = h};
    Advance in{.f = f,
               .t = double(i) * h,
               .t_end = double(i + 1) * h,
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .tolerance = {.relative = 0, .absolute = 1e300}};
    m.advance(in);
    EXPECT_EQ(in.reached, in.t_end);
  }
  return y;
}

double error(const std::vector<double>& y, const std::vector<double>& end) {
  double worst = 0;
  for (size_t i = 0; i < end.size(); ++i) worst = std::max(worst, std::abs(y[i] - end[i]));
  return worst;
}

TEST(Advance, EveryRowHasItsOrder) {
  const auto f = kepler_orbit();
  const auto end = kepler_state(0.2, 5);
  for (const Integrator& m : integrators()) {
    if (!explicit_row(m) || refusal(m, f)) continue;
    // Halvings around errors of 1e-6 to 1e-9, where the leading term dominates and rounding does not.
    size_t n = 8;
    while (n < 100000 && error(equal_steps(m, f, kepler_start(0.2), 5, n), end) > (m.order < 3 ? 1e-4 : 1e-7))
      n *= 2;
    const double coarse = error(equal_steps(m, f, kepler_start(0.2), 5, n), end),
                 fine = error(equal_steps(m, f, kepler_start(0.2), 5, 2 * n), end);
    if (m.order > 8) {
      EXPECT_LT(fine, 1e-11) << m.name;
      continue;
    }
    // One halving without extrapolation: a quarter of an order below 5; dop853 is still converging to 8 here.
    EXPECT_NEAR(std::log2(coarse / fine), m.order, m.order < 5 ? 0.25 : m.order < 8 ? 0.6 : 0.99) << m.name;
  }
}

TEST(Advance, FixedStepsDivideTheRunAndWatchersSeeThem) {
  struct Counter final : StepWatcher {
    size_t steps = 0;
    double last = 0, middle_error = 0;
    Verdict accepted(double t0, double& t1, double*, const Interpolant& between) override {
      EXPECT_EQ(t0, last) << "steps follow each other";
      last = t1, ++steps;
      std::vector<double> y(4);
      between.at(0.5, y.data());
      middle_error = std::max(middle_error, error(y, kepler_state(0.2, 0.5 * (t0 + t1))));
      return Verdict::go_on;
    }
  };
  const auto f = kepler_orbit();
  for (const Integrator& m : integrators()) {
    if (!explicit_row(m) || refusal(m, f) || m.stepping == Integrator::Stepping::adaptive) continue;
    auto watched = kepler_start(0.2), alone = watched;
    for (auto* y : {&watched, &alone}) {
      Workspace workspace;
      Carry carry;
      Counter counter;
      Statistics statistics;
      Advance in{.f = f,
                 .t = 0,
                 .t_end = 5,
                 .y = y->data(),
                 .workspace = workspace,
                 .carry = carry,
                 .fixed_steps = 2000,
                 .watcher = y == &watched ? &counter : nullptr,
                 .statistics = &statistics};
      m.advance(in);
      EXPECT_EQ(statistics.steps, 2000u) << m.name;
      EXPECT_EQ(in.reached, 5.0);
      if (y != &watched) continue;
      EXPECT_EQ(counter.steps, 2000u) << m.name;
      // The interpolant adds little to the method's own error, which is largest near the pericentre.
      EXPECT_LT(counter.middle_error, 3 * error(watched, kepler_state(0.2, 5)) + (m.order == 1 ? 5e-2 : 1e-6))
          << m.name;
    }
    // Combined drifts round differently.
    EXPECT_LT(error(watched, alone), 1e-12) << m.name;
  }
}

TEST(Advance, DenseOutputHasItsOrder) {
  // Largest error at nine points of one step from the pericentre, halved: the local order, one above the
  // promised one.
  struct Places final : StepWatcher {
    double worst = 0;
    Verdict accepted(double t0, double& t1, double*, const Interpolant& between) override {
      std::vector<double> y(4);
      for (int i = 1; i < 10; ++i) {
        between.at(0.1 * i, y.data());
        worst = std::max(worst, error(y, kepler_state(0.2, t0 + 0.1 * i * (t1 - t0))));
      }
      return Verdict::go_on;
    }
  };
  const auto f = kepler_orbit();
  const auto local = [&](const char* method, double h) {
    auto y = kepler_start(0.2);
    Workspace workspace;
    Carry carry{.step = h};
    Places places;
    Advance in{.f = f,
               .t = 0,
               .t_end = h,
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .tolerance = {.relative = 0, .absolute = 1e300},
               .watcher = &places};
    find_integrator(method)->advance(in);
    return places.worst;
  };
  const struct {
    const char* method;
    int order;  // of the interpolant
    double h;
  } rows[] = {{"bs32", 3, 0.1},   {"rkf45", 3, 0.1}, {"dopri5", 4, 0.1},  {"tsit5", 4, 0.1},
              {"dop853", 7, 0.3}, {"rkn86", 4, 0.1}, {"rkn1210", 4, 0.1}, {"ssprk104", 3, 0.1}};
  for (const auto& r : rows) {
    const double observed = std::log2(local(r.method, r.h) / local(r.method, 0.5 * r.h));
    EXPECT_NEAR(observed, r.order + 1, 0.4) << r.method;
  }
  EXPECT_LT(local("ias15", 0.3), 1e-10) << "the collocation polynomial itself";
}

TEST(Advance, RunsInPiecesRepeatFromTheCarryAlone) {
  const auto f = pleiades();
  for (const Integrator& m : integrators()) {
    if (!explicit_row(m) || refusal(m, f)) continue;
    const auto run = [&](bool forget) {
      auto y = pleiades_start();
      Workspace workspace;
      Carry carry;
      for (int i = 0; i < 6; ++i) {
        if (forget) workspace.clear();
        Advance in{.f = f,
                   .t = 0.1 * i,
                   .t_end = 0.1 * (i + 1),
                   .y = y.data(),
                   .workspace = workspace,
                   .carry = carry,
                   .fixed_steps = 20};
        m.advance(in);
      }
      return y;
    };
    EXPECT_EQ(run(true), run(false)) << m.name;
  }
}

// y' = y up to t = 0.5, then NaN in one component.
class Broken final : public RightHandSide {
 public:
  explicit Broken(size_t n) : n_(n) {}
  size_t size() const override { return n_; }
  void rate(double t, const double* y, double* d) const override {
    for (size_t i = 0; i < n_; ++i) d[i] = y[i];
    if (t > 0.5) d[n_ - 2] = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  size_t n_;
};

TEST(Advance, NamesWhatIsNoNumberAndWhatTookTooLong) {
  for (const size_t n : {2u, 3u, 100u}) {
    const Broken f(n);
    for (const char* method : {"bs32", "rkf45", "dopri5", "tsit5", "dop853", "ssprk104", "step_doubling"}) {
      std::vector<double> y(n, 1.0);
      Workspace workspace;
      Carry carry;
      Advance in{.f = f, .t = 0, .t_end = 1, .y = y.data(), .workspace = workspace, .carry = carry};
      try {
        find_integrator(method)->advance(in);
        ADD_FAILURE() << method;
      } catch (const Instability& e) {
        EXPECT_EQ(e.index, static_cast<long long>(n) - 2) << method << " n = " << n;
      }
      in.t_end = 0.4;
      in.max_steps = 2;
      in.tolerance = {1e-12, 1e-12};
      carry = {};
      std::fill(y.begin(), y.end(), 1.0);
      EXPECT_THROW(find_integrator(method)->advance(in), Instability) << method;
    }
  }
}

TEST(Advance, TolerancesPerComponent) {
  // Two separate oscillators; the second may be wrong.
  const Equations f(4, [](double, const double* y, double* d) {
    d[0] = y[1], d[1] = -y[0], d[2] = y[3], d[3] = -100 * y[2];
  });
  const auto run = [&](const char* method, const std::vector<double>& each) {
    std::vector<double> y = {1, 0, 1, 0};
    Workspace workspace;
    Carry carry;
    Statistics statistics;
    Advance in{.f = f,
               .t = 0,
               .t_end = 10,
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .tolerance = {.relative = 0, .absolute = 1e-9, .absolute_each = each},
               .statistics = &statistics};
    find_integrator(method)->advance(in);
    EXPECT_LT(std::abs(y[0] - std::cos(10.0)), 1e-7) << method;
    return statistics.steps;
  };
  for (const char* method : {"dopri5", "dop853"}) {
    EXPECT_LT(2 * run(method, {1e-9, 1e-9, 1e3, 1e3}), run(method, {1e-9, 1e-9, 1e-9, 1e-9})) << method;
    EXPECT_EQ(run(method, {}), run(method, {1e-9, 1e-9, 1e-9, 1e-9})) << method;
  }
}

TEST(StepControl, RoughPowersAreRightToTheirPromise) {
  for (double x = 1e-300; x < 1e300; x *= 1.37) {
    EXPECT_NEAR(step_control::rough_log2(x), std::log2(x), 4e-6) << x;
  }
  for (double x = -900; x < 900; x += 0.173) {
    EXPECT_NEAR(step_control::rough_exp2(x) / std::exp2(x), 1, 8e-6) << x;
  }
}

}  // namespace
}  // namespace truestep::test
