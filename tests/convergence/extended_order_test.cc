// Explicit rows of order 5 and more show their order to within 0.1 with 33 digits (extended.h), and the
// product's steps equal those of the witness.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/integrators/explicit/ias15_nodes.h"
#include "engine/integrators/explicit/tableau_dop853.h"
#include "engine/integrators/table/integrators.h"
#include "tests/convergence/extended.h"

namespace truestep::test {

void PrintTo(const ExtendedProblem& p, std::ostream* out) {
  *out << p.name;
}

namespace {

constexpr double kTolerance = 0.1;

struct Witness {
  const char* row;
  ExtendedStep step;
  size_t tie;  ///< steps at which the product is compared; its error is visible there
};
const std::vector<Witness>& witnesses() {
  static const std::vector<Witness> kAll = {
      {"yoshida6", extended(kYoshida6), 40},          {"yoshida8", extended(kYoshida8), 30},
      {"kahan_li8", extended(kKahanLi8), 20},         {"step_doubling", extended(kStepDoublingTableau), 40},
      {"rkf45", extended(kRkf45Tableau), 40},         {"dopri5", extended(kDopri5Tableau), 40},
      {"tsit5", extended(kTsit5Tableau), 40},         {"dop853", extended(kDop853Tableau), 15},
      {"rkn86", extended(kRkn86Tableau), 15},         {"rkn1210", extended(kRkn1210Tableau), 5},
      {"ias15", extended_collocation(kIas15Nodes), 4}};
  return kAll;
}

int promise(const Integrator& m, const ExtendedProblem& p) {
  return p.moving ? m.order_with_velocity : m.order;
}

// Windows in which the leading term dominates, found by where the fits settle. Rounded coefficients, 1e-16
// and less of the error, are separated up to a power well below the promised order.
double order_of(const ExtendedStep& step, const ExtendedProblem& p, int promised) {
  if (promised >= 15) return extended_order(step, p, 4, {1e-19, 1e-24, 4});
  if (promised >= 12) return extended_order(step, p, 7, {1e-15, 1e-18, 4});
  if (promised >= 8) return extended_order(step, p, 2, {1e-11, 1e-14, 4});
  return extended_order(step, p, 0, {1e-10, 1e-13, 4});
}

class ExtendedOrder : public ::testing::TestWithParam<ExtendedProblem> {
 protected:
  // use(witness, row, promised order) for the rows that serve the problem with order 5 or more.
  template <class Use>
  void each_row(Use&& use) {
    const Problem in_double = GetParam().in_double();
    for (const Witness& w : witnesses()) {
      const Integrator& m = *find_integrator(w.row);
      const int promised = promise(m, GetParam());
      if (promised >= 5 && !refusal(m, *in_double.field)) use(w, m, promised);
    }
  }
};

TEST_P(ExtendedOrder, IsWhatTheRowPromises) {
  each_row([](const Witness& w, const Integrator&, int promised) {
    const double observed = order_of(w.step, GetParam(), promised);
    std::printf("%-18s %-14s promised %d observed %.3f\n", GetParam().name, w.row, promised, observed);
    EXPECT_NEAR(observed, promised, kTolerance) << w.row;
  });
}

TEST_P(ExtendedOrder, TheProductTakesTheWitnessSteps) {
  each_row([](const Witness& w, const Integrator& m, int) {
    // The product's end taken as the exact solution: the rest is rounding, some 1e-16 per step.
    const auto end = extended_end(w.step, GetParam(), w.tie);
    Problem p = GetParam().in_double();
    const double error = end_error(m, p, w.tie, {.tolerance = 1e300});
    for (size_t i = 0; i < end.size(); ++i) {
      (i < p.x_end.size() ? p.x_end[i] : p.v_end[i - p.x_end.size()]) = static_cast<double>(end[i]);
    }
    EXPECT_LT(end_error(m, p, w.tie, {.tolerance = 1e300}), 1e-13) << w.row;
    // Control: the method's own error is far above that, and below what another method would leave.
    EXPECT_GT(error, 1e-12) << w.row;
    EXPECT_LT(error, 1e-3) << w.row;
  });
}

INSTANTIATE_TEST_SUITE_P(Problems, ExtendedOrder, ::testing::ValuesIn(extended_problems()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(ExtendedOrderControl, EveryRowIsThere) {
  // Rows that the test of the table leaves to this one.
  for (const Integrator& m : integrators()) {
    if (m.order < 5 || m.kind != Integrator::Kind::explicit_ || m.name.starts_with("cvode")) continue;
    EXPECT_TRUE(std::ranges::any_of(witnesses(), [&](const Witness& w) { return m.name == w.row; }))
        << m.name;
  }
}

// log2 of |y_n - y_2n| / |y_2n - y_4n|.
double slope(const ExtendedStep& step, const ExtendedProblem& p, size_t n) {
  const auto a = extended_end(step, p, n), b = extended_end(step, p, 2 * n), c = extended_end(step, p, 4 * n);
  Extended coarse = 0, fine = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    coarse += (a[i] - b[i]) * (a[i] - b[i]), fine += (b[i] - c[i]) * (b[i] - c[i]);
  }
  return 0.5 * std::log2(static_cast<double>(coarse / fine));
}

TEST(ExtendedOrderControl, AChangedCoefficientLosesTheOrder) {
  // Changed by one in a thousand, with the sums over each row preserved. The measured slope is a single one,
  // still converging to the order.
  const ExtendedProblem p = extended_problems()[2];
  const auto check = [&](const char* name, const ExtendedStep& right, const ExtendedStep& wrong, size_t n,
                         int order) {
    EXPECT_GT(slope(right, p, n), order - 1.5) << name;
    EXPECT_LT(slope(wrong, p, n), order - 3) << name;
  };
  Tableau pair = kDop853Tableau;
  pair.a[9][5] += 1e-3, pair.a[9][4] -= 1e-3;
  check("dop853", extended(kDop853Tableau), extended(pair), 40, 8);
  NystromTableau nystrom = kRkn1210Tableau;
  nystrom.a[9][5] += 1e-3, nystrom.a[9][4] -= 1e-3;
  check("rkn1210", extended(kRkn1210Tableau), extended(nystrom), 10, 12);
  Splitting splitting = kKahanLi8;
  splitting.kick[3] += 1e-3, splitting.kick[13] -= 1e-3;
  check("kahan_li8", extended(kKahanLi8), extended(splitting), 20, 8);
  auto nodes = kIas15Nodes;
  nodes[3] += 1e-3;
  check("ias15", extended_collocation(kIas15Nodes), extended_collocation(nodes), 12, 15);
}

}  // namespace
}  // namespace truestep::test
