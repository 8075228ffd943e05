// Methods that remember their last step: steps of unequal length, and a solution that was changed in between.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_problems.h"

namespace truestep::test {
namespace {

// x'' = -x - 0.4 x'
class Damped final : public RightHandSide, public SecondOrder {
 public:
  size_t size() const override { return 2; }
  const SecondOrder* second_order() const override { return this; }
  bool depends_on_velocity() const override { return true; }
  void rate(double t, const double* y, double* d) const override {
    d[0] = y[1];
    acceleration(t, y, y + 1, d + 1);
  }
  void acceleration(double, const double* x, const double* v, double* a) const override {
    a[0] = -x[0] - 0.4 * v[0];
  }
};

struct Course {
  Course(const char* method, const RightHandSide& f, std::vector<double> start)
      : row(*find_integrator(method)), f(f), y(std::move(start)), memory(row.memory(y.size())) {}
  void step(double h) {
    Advance a{.f = f,
              .t = t,
              .t_end = t + h,
              .y = y.data(),
              .workspace = workspace,
              .carry = carry,
              .fixed_steps = 1,
              .memory = memory};
    row.advance(a);
    t += h;
  }
  void forget() { std::fill(memory.begin(), memory.end(), std::numeric_limits<double>::quiet_NaN()); }

  const Integrator& row;
  const RightHandSide& f;
  std::vector<double> y, memory;
  Workspace workspace;
  Carry carry;
  double t = 0;
};

// Of order 2 with any ratio of steps: a parabola is exact.
TEST(UnequalSteps, Bdf2FollowsAParabola) {
  const auto rate = [](double t, const double*, double* d) { d[0] = 1 - 2 * t; };
  const Equations<decltype(rate)> f(1, rate);
  Course course("bdf2", f, {3});
  for (const double h : {0.1, 0.1, 0.05, 0.2, 0.3, 0.01, 0.1}) {
    course.step(h);
    EXPECT_NEAR(course.y[0], 3 + course.t - course.t * course.t, 1e-12) << "after a step of " << h;
  }
}

// What is remembered belongs to the solution that was left: after a blow the method starts anew.
TEST(UnequalSteps, AChangedVelocityIsANewStart) {
  const Damped f;
  for (const char* method : {"bdf2", "generalized_alpha"}) {
    Course remembers(method, f, {1, 0}), forgets(method, f, {1, 0});
    for (int k = 0; k < 5; ++k) remembers.step(0.1), forgets.step(0.1);
    remembers.y[1] += 2, forgets.y[1] += 2;
    forgets.forget();
    remembers.step(0.1), forgets.step(0.1);
    EXPECT_EQ(remembers.y, forgets.y) << method;
    // Control: it matters what is remembered.
    forgets.forget();
    remembers.step(0.1), forgets.step(0.1);
    EXPECT_NE(remembers.y, forgets.y) << method;
  }
}

// Long columns have loops of their own: they do the same to many equal equations as to a few.
TEST(UnequalSteps, ManyEquationsGoAsAFew) {
  const auto rate = [](double t, const double* y, double* d, size_t n) {
    for (size_t i = 0; i < n; ++i) d[i] = -y[i] + std::cos(3 * t);
  };
  constexpr size_t kFew = 2, kMany = 500;
  const auto few = [&](double t, const double* y, double* d) { rate(t, y, d, kFew); };
  const auto many = [&](double t, const double* y, double* d) { rate(t, y, d, kMany); };
  const Equations<decltype(few)> a(kFew, few);
  const Equations<decltype(many)> b(kMany, many);
  size_t seen = 0;
  for (const Integrator& m : integrators()) {
    if (!m.advance || m.kind != Integrator::Kind::explicit_ || m.name.starts_with("cvode") || refusal(m, a))
      continue;
    const auto end = [&](const RightHandSide& f) {
      std::vector<double> y(f.size(), 0.5), memory(m.memory ? m.memory(f.size()) : 0);
      Workspace workspace;
      Carry carry;
      Advance in{.f = f,
                 .t = 0,
                 .t_end = 1,
                 .y = y.data(),
                 .workspace = workspace,
                 .carry = carry,
                 .tolerance = {.relative = 1e-6, .absolute = 1e-6},
                 .fixed_steps = m.stepping == Integrator::Stepping::adaptive ? uint64_t{0} : uint64_t{20},
                 .memory = memory};
      m.advance(in);
      return y;
    };
    const auto short_end = end(a), long_end = end(b);
    // Step sizes follow from sums whose order differs.
    EXPECT_NEAR(long_end.front(), short_end.front(), 1e-11) << m.name;
    EXPECT_EQ(long_end.back(), long_end.front()) << m.name;
    ++seen;
  }
  EXPECT_GE(seen, 10u);
}

}  // namespace
}  // namespace truestep::test
