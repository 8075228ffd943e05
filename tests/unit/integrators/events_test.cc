// Events are found at their exact times, to rounding, in order, with direction, and stop a run at their own
// time.
#include "engine/integrators/control/events.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_problems.h"

namespace truestep::test {
namespace {

class Functions final : public Guards {
 public:
  using G = std::function<double(double t, const double* y)>;
  explicit Functions(std::vector<G> g) : g_(std::move(g)) {}
  void evaluate(double t, const double* y, double* out) override {
    for (size_t k = 0; k < g_.size(); ++k) out[k] = g_[k](t, y);
  }

 private:
  std::vector<G> g_;
};

struct Hit {
  uint32_t guard;
  double t;
};

struct Watched {
  Watched(std::vector<double> start, std::vector<Functions::G> g, std::vector<Crossing> ways)
      : y(std::move(start)),
        guards(std::move(g)),
        directions(std::move(ways)),
        sides(directions.size()),
        watcher(guards, directions, y.size()) {
    watcher.attach(sides);
  }
  // One run, stopped by the first event.
  double go(const RightHandSide& f, const char* method, double t, double t_end, double tolerance) {
    Advance in{.f = f,
               .t = t,
               .t_end = t_end,
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .tolerance = {tolerance, tolerance},
               .watcher = &watcher};
    watcher.look(t, y.data());
    watcher.clear();
    find_integrator(method)->advance(in);
    for (const uint32_t k : watcher.fired()) hits.push_back({k, in.reached});
    return in.reached;
  }

  std::vector<double> y;
  Workspace workspace = {};
  Carry carry = {};
  Functions guards;
  std::vector<Crossing> directions;
  std::vector<int32_t> sides;
  EventWatcher watcher;
  std::vector<Hit> hits = {};
};

struct HarmonicForce {
  void operator()(const double* x, double* a) const { a[0] = -x[0]; }
};

TEST(Events, CosineVanishesAtHalfIntegersOfPi) {
  const Motions<HarmonicForce> f(1, {});
  const Functions::G x = [](double, const double* y) { return y[0]; };
  // The error is that of the interpolant; orders 4 and below need the tolerance that makes short steps.
  const std::pair<const char*, double> methods[] = {
      {"dop853", 1e-8}, {"dopri5", 1e-7}, {"tsit5", 1e-7}, {"bs32", 1e-6}, {"rkn86", 1e-8}};
  for (const auto& [method, error] : methods) {
    Watched run({1, 0}, {x, x, x}, {Crossing::either, Crossing::rising, Crossing::falling});
    for (double t = 0; t < 20;) t = run.go(f, method, t, 20, 1e-10);
    size_t count[3] = {};
    double last = 0;
    for (const Hit& hit : run.hits) {
      ++count[hit.guard];
      const double turns = hit.t / M_PI - 0.5;
      EXPECT_NEAR(turns, std::round(turns), error) << method;
      const bool rising = static_cast<long>(std::round(turns)) % 2 == 1;
      if (hit.guard > 0) {
        EXPECT_EQ(rising, hit.guard == 1);
      }
      EXPECT_GE(hit.t, last) << "order of time";
      last = hit.t;
    }
    EXPECT_EQ(count[0], 6u) << method;
    EXPECT_EQ(count[1], 3u) << method;
    EXPECT_EQ(count[2], 3u) << method;
  }
}

TEST(Events, ABallBouncesAtItsTimes) {
  // Height 1 under g = 2: the floor at t = 1; bounces reverse the speed and halve it (e = 1/2): impacts at 1,
  // 1 + 1, 2 + 1/2, 2.5 + 1/4 ...
  struct Fall {
    void operator()(const double*, double* a) const { a[0] = -2; }
  };
  const Motions<Fall> f(1, {});
  Watched run({1, 0}, {[](double, const double* y) { return y[0]; }}, {Crossing::falling});
  double t = 0, expected = 1, pause = 1;
  for (int bounce = 0; bounce < 6; ++bounce) {
    t = run.go(f, "tsit5", t, 10, 1e-9);
    ASSERT_EQ(run.watcher.fired(), std::vector<uint32_t>{0}) << bounce;
    // Parabolas are exact in every interpolant; what is left is rounding.
    EXPECT_NEAR(t, expected, 1e-12) << bounce;
    EXPECT_NEAR(run.y[0], 0, 1e-12);
    run.y[0] = 0, run.y[1] *= -0.5;
    expected += pause, pause *= 0.5;
  }
  EXPECT_EQ(run.hits.size(), 6u);
}

TEST(Events, CrossingsOfOneStepHappenInTheirOrder) {
  // The parabola crosses the line at 0.4 and 1.6; with constant acceleration one step covers it all.
  struct Fall {
    void operator()(const double*, double* a) const { a[0] = -2; }
  };
  const Motions<Fall> f(1, {});
  Watched run(
      {0, 2},
      {[](double, const double* y) { return y[0] - 0.64; }, [](double t, const double*) { return t - 1.5; }},
      {Crossing::either, Crossing::rising});
  run.carry.step = 4;
  for (double t = 0; t < 4;) t = run.go(f, "dopri5", t, 4, 1e-3);
  const std::vector<std::pair<uint32_t, double>> expected = {{0, 0.4}, {1, 1.5}, {0, 1.6}};
  ASSERT_EQ(run.hits.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(run.hits[i].guard, expected[i].first);
    EXPECT_NEAR(run.hits[i].t, expected[i].second, 1e-12);
  }
}

TEST(Events, RootsAreExactAndBracketed) {
  // Functions that are hard for secants: a flat one, a steep one, one shaped like a pole.
  const std::function<double(double)> functions[] = {
      [](double x) { return x * x * x * x * x - 1e-10; }, [](double x) { return std::tanh(1e4 * (x - 0.3)); },
      [](double x) { return 1 / (1.0001 - x) - 2; }, [](double x) { return x < 0.7 ? -1e-3 : 1.0; }};
  const double roots[] = {1e-2, 0.3, 0.5001, 0.7};
  for (int i = 0; i < 4; ++i) {
    int calls = 0;
    const std::function<double(double)> counted = [&](double x) { return ++calls, functions[i](x); };
    EXPECT_NEAR(bracketed_root(counted, 0, functions[i](0), 1, functions[i](1), 1e-15), roots[i], 1e-12) << i;
    EXPECT_LT(calls, 80) << i << ": bisection alone takes 50";
  }
}

}  // namespace
}  // namespace truestep::test
