// Choosing a method asks the field no more than the method needs: a field of a million points is not started
// once for every method of the table.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/core/equations/force_field.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {
namespace {

/// A point at rest that counts how often it is started.
class Counted : public ForceField {
 public:
  State initial_state() const override {
    ++starts;
    State s;
    s.add({"position", "m", Scalar::f64, 3, Role::position}, 1);
    s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, 1);
    return s;
  }
  void acceleration(const Phase&, std::span<double> a, Evaluation&) const override {
    std::ranges::fill(a, 0.0);
  }
  Dependence dependence() const override { return Dependence::position; }
  double kinetic(const Phase&, Evaluation&) const override { return 0; }

  mutable int starts = 0;
};

TEST(ChosenMethod, AsksOnlyForTheOneThatIsWanted) {
  for (const Integrator& m : integrators()) {
    Counted field;
    refusal(m, field);
    const int alone = field.starts;
    field.starts = 0;
    try {
      choose_integrator({std::string(m.name), {}}, "rk4", field);
      EXPECT_EQ(field.starts, alone) << m.name;
    } catch (const Error&) {
      EXPECT_GE(field.starts, alone) << m.name;  // the refusal lists what would do
    }
  }
}

// The control: the answer to a wrong name does list the methods, for which each is asked.
TEST(ChosenMethod, AWrongNameIsAnsweredWithThoseThatFit) {
  Counted field;
  try {
    choose_integrator({"velocity_verlett", {}}, "rk4", field);
    FAIL();
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1U);
    EXPECT_NE(e.issues()[0].allowed.find("velocity_verlet"), std::string::npos);
    EXPECT_EQ(e.issues()[0].did_you_mean, "velocity_verlet");
    EXPECT_GT(field.starts, 1);
  }
}

}  // namespace
}  // namespace truestep
