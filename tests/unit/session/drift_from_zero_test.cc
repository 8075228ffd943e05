// A drift is relative to the largest initial value among the quantities of its group and unit, and absolute
// where all of them start at 0: never a quotient by almost zero.
#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/session/expectation.h"

namespace truestep {
namespace {

Verdict drift(const std::string& name, std::initializer_list<Observables> steps) {
  Scene scene;
  ExpectParams expected;
  expected.quantity = "drift(" + name + ")", expected.max = 1e-3;
  scene.header.expect.push_back(expected);
  Expectations e(scene);
  double t = 0;
  for (const Observables& o : steps) e.add(o, t++);
  return e.verdicts().at(0);
}

Observables energies(double kinetic, double total) {
  Observables o;
  o.add("energy.kinetic", kinetic, "J"), o.add("energy.total", total, "J"), o.add("energy.ratio", 1e9, "1");
  return o;
}

TEST(Drift, FromZeroIsAbsolute) {
  const Verdict v = drift("energy.total", {energies(0, 0), energies(3, 2e-5)});
  EXPECT_DOUBLE_EQ(*v.measured, 2e-5);
  EXPECT_EQ(v.drift_scale, 0.0);
  EXPECT_TRUE(v.met);
}

TEST(Drift, IsRelativeToItsGroupAndUnit) {
  const Verdict v = drift("energy.total", {energies(4, 0), energies(4, 2e-5)});
  EXPECT_DOUBLE_EQ(*v.measured, 5e-6);
  EXPECT_EQ(v.drift_scale, 4.0);
  // The control: a larger drift violates its bound.
  EXPECT_FALSE(drift("energy.total", {energies(4, 0), energies(4, 0.02)}).met);
}

TEST(Drift, OfANameWithoutGroupIsRelativeToItself) {
  Observables a, b;
  a.add("x", 2, "1"), a.add("y", 100, "1"), b.add("x", 3, "1"), b.add("y", 100, "1");
  EXPECT_DOUBLE_EQ(*drift("x", {a, b}).measured, 0.5);
}

}  // namespace
}  // namespace truestep
