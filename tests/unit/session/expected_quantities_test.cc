// What expectations can measure: reductions over a run, expressions of such, windows of time, energy that
// comes from nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/session/expectation.h"

namespace truestep {
namespace {

ExpectParams quantity(const std::string& text) {
  ExpectParams e;
  e.quantity = text;
  return e;
}

/// x = t^2 - 1 at t = 0, 0.5 ... 2, energies of a body that falls and gains 1 J of its 10 J on the way.
double measured(const ExpectParams& expected) {
  Scene scene;
  scene.header.expect.push_back(expected);
  Expectations e(scene);
  for (int k = 0; k <= 4; ++k) {
    const double t = 0.5 * k;
    Observables o;
    o.add("a.x", t * t - 1, "m"), o.add("b-1.x", 10, "m");
    o.add("energy.potential", 10 - 2.5 * k, "J"), o.add("energy.total", 10 + (k == 3), "J");
    e.add(o, t);
  }
  const Verdict v = e.verdicts().at(0);
  EXPECT_TRUE(v.measured.has_value()) << expected.quantity;
  return v.measured.value_or(NAN);
}
double measured(const std::string& text) {
  return measured(quantity(text));
}

TEST(ExpectedQuantities, ReduceARun) {
  EXPECT_DOUBLE_EQ(measured("a.x"), 3);
  EXPECT_DOUBLE_EQ(measured("start(a.x)"), -1);
  EXPECT_DOUBLE_EQ(measured("min(a.x)"), -1);
  EXPECT_DOUBLE_EQ(measured("max(a.x)"), 3);
  EXPECT_DOUBLE_EQ(measured("mean(a.x)"), (-1 - 0.75 + 0 + 1.25 + 3) / 5);
  EXPECT_DOUBLE_EQ(measured("change(a.x)"), 4);
  EXPECT_DOUBLE_EQ(measured("largest(a.x)"), 3);
  EXPECT_DOUBLE_EQ(measured("drift(b-1.x)"), 0);
}

TEST(ExpectedQuantities, AreExpressions) {
  EXPECT_DOUBLE_EQ(measured("max(a.x) - start(a.x) + 1e-1*t"), 4.2);
  EXPECT_DOUBLE_EQ(measured("largest(a.x - t^2)"), 1);
  EXPECT_DOUBLE_EQ(measured("largest( a.x - (t*t - 1) )"), 0);
  EXPECT_DOUBLE_EQ(measured("min(a.x, 2)"), 2) << "of two values it is the usual function";
  EXPECT_DOUBLE_EQ(measured("sqrt(max(a.x) + 1)"), 2);
}

TEST(ExpectedQuantities, CountInAWindow) {
  ExpectParams e = quantity("a.x");
  e.until = 1;
  EXPECT_DOUBLE_EQ(measured(e), 0);
  e.quantity = "max(a.x) + t", e.from = 0.5;
  EXPECT_DOUBLE_EQ(measured(e), 1);
}

TEST(ExpectedQuantities, CompareParts) {
  EXPECT_DOUBLE_EQ(measured("max(a.x, 1.5, 2) / max(a.x, 0, 1.5)"), 3 / 1.25);
  EXPECT_DOUBLE_EQ(measured("start(a.x, 0.5, 2)"), -0.75);
}

TEST(ExpectedQuantities, SeeEnergyFromNothing) {
  constexpr double kRounded = 1e-7;  // places of single precision
  EXPECT_NEAR(measured("energy.gain"), 0.1, kRounded);
  EXPECT_EQ(measured("energy.loss"), 0);
  ExpectParams e = quantity("energy.gain");
  e.given = 1;
  EXPECT_EQ(measured(e), 0) << "what a motor gives is none";
}

}  // namespace
}  // namespace truestep
