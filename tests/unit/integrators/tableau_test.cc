// Every tableau satisfies the order conditions of its promised order: all rooted trees up to that order, the
// row sums, the embedded weights, and "first same as last". A changed digit fails.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/explicit/tableau_dop853.h"
#include "tests/support/rooted_trees.h"

namespace truestep::test {
namespace {

// Coefficients up to 50 in size round to 1e-14 in products of a few; the methods' exact ones leave 0.
constexpr double kTableauTolerance = 1e-13;

struct NamedTableau {
  const char* name;
  const Tableau& tableau;
};
constexpr NamedTableau kAll[] = {
    {"euler", kEulerTableau},       {"midpoint", kMidpointTableau}, {"heun", kHeunTableau},
    {"rk4", kRk4Tableau},           {"bs32", kBs32Tableau},         {"step_doubling", kStepDoublingTableau},
    {"rkf45", kRkf45Tableau},       {"dopri5", kDopri5Tableau},     {"tsit5", kTsit5Tableau},
    {"ssprk104", kSsprk104Tableau}, {"dop853", kDop853Tableau}};

ElementaryWeights weights_of(const Tableau& t, const std::vector<RootedTree>& trees) {
  return elementary_weights(
      trees, t.stages, [&](size_t i, size_t l) { return t.a[i][l]; }, [&](size_t i) { return t.c[i]; }, 1);
}

// Largest defect of the conditions up to `order`.
double defect(const Tableau& t, const Tableau::Weights& b, size_t order) {
  const auto trees = first_order_trees(order);
  const auto w = weights_of(t, trees);
  double worst = 0;
  for (size_t k = 0; k < trees.size(); ++k) {
    double sum = -w.exact[k] / static_cast<double>(trees[k].order);
    for (size_t i = 0; i < t.stages; ++i) sum += b[i] * w.stages[k][i];
    worst = std::max(worst, std::abs(sum));
  }
  return worst;
}

Tableau::Weights embedded(const Tableau& t, const Tableau::Weights& error) {
  Tableau::Weights b = t.b;
  for (size_t i = 0; i < t.stages; ++i) b[i] -= error[i];
  return b;
}

TEST(Tableaus, TreesAreCountedAsInTheLiterature) {
  // Hairer, Norsett, Wanner 1993, table II.2.2.
  const size_t counts[] = {1, 2, 4, 8, 17, 37, 85, 200};
  for (size_t order = 1; order <= 8; ++order) EXPECT_EQ(first_order_trees(order).size(), counts[order - 1]);
}

TEST(Tableaus, RowsSumToTheirNodes) {
  for (const NamedTableau& m : kAll) {
    for (size_t i = 0; i < m.tableau.stages; ++i) {
      double sum = -m.tableau.c[i];
      for (size_t j = 0; j < m.tableau.stages; ++j) sum += m.tableau.a[i][j];
      EXPECT_NEAR(sum, 0, kTableauTolerance) << m.name << " row " << i;
      for (size_t j = i; j < m.tableau.stages; ++j) EXPECT_EQ(m.tableau.a[i][j], 0) << m.name;
    }
  }
}

TEST(Tableaus, OrderConditionsHoldAndNoMore) {
  for (const NamedTableau& m : kAll) {
    const auto order = static_cast<size_t>(m.tableau.order);
    EXPECT_LT(defect(m.tableau, m.tableau.b, order), kTableauTolerance) << m.name;
    EXPECT_GT(defect(m.tableau, m.tableau.b, order + 1), 1e-7) << m.name << " promises too little";
  }
}

TEST(Tableaus, EmbeddedSolutionsHaveTheirOrders) {
  for (const NamedTableau& m : kAll) {
    const Tableau& t = m.tableau;
    if (t.error_order == 0) continue;
    const auto order = static_cast<size_t>(t.error_order);
    EXPECT_LT(defect(t, embedded(t, t.error), order), kTableauTolerance) << m.name;
    EXPECT_GT(defect(t, embedded(t, t.error), order + 1), 1e-6) << m.name << " promises too little";
  }
  EXPECT_LT(defect(kDop853Tableau, embedded(kDop853Tableau, kDop853Tableau.second_error), 3),
            kTableauTolerance);
  EXPECT_GT(defect(kDop853Tableau, embedded(kDop853Tableau, kDop853Tableau.second_error), 4), 1e-6);
}

TEST(Tableaus, FirstSameAsLastWhereThePapersSaySo) {
  for (const NamedTableau& m : kAll) {
    const std::string name = m.name;
    const bool promised = name == "bs32" || name == "dopri5" || name == "tsit5" || name == "dop853";
    EXPECT_EQ(m.tableau.first_same_as_last(), promised) << name;
  }
}

TEST(Tableaus, DenseOutputHasItsOrderEverywhere) {
  // b_i(theta) against theta^rho: every tree up to the dense order, at points between the ends.
  for (const NamedTableau& m : kAll) {
    const Tableau& t = m.tableau;
    if (t.dense_order != 4) continue;
    const auto trees = first_order_trees(4);
    const auto w = weights_of(t, trees);
    for (const double theta : {0.0, 0.1, 0.5, 0.83, 1.0}) {
      for (size_t k = 0; k < trees.size(); ++k) {
        const auto rho = static_cast<double>(trees[k].order);
        double sum = -w.exact[k] * std::pow(theta, rho) / rho;
        for (size_t i = 0; i < t.stages; ++i) {
          const auto& p = t.dense[i];
          sum += theta * (p[0] + theta * (p[1] + theta * (p[2] + theta * p[3]))) * w.stages[k][i];
        }
        EXPECT_NEAR(sum, 0, kTableauTolerance) << m.name << " at " << theta;
      }
    }
    for (size_t i = 0; i < t.stages; ++i) {
      const auto& p = t.dense[i];
      EXPECT_NEAR(p[0] + p[1] + p[2] + p[3], t.b[i], kTableauTolerance) << m.name;
    }
  }
}

TEST(Tableaus, AChangedDigitFails) {
  for (const NamedTableau& m : kAll) {
    if (m.tableau.order < 2) continue;
    for (size_t i = 1; i < m.tableau.stages; ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (m.tableau.a[i][j] == 0) continue;
        Tableau wrong = m.tableau;
        wrong.a[i][j] += 1e-7;
        bool seen = defect(wrong, wrong.b, static_cast<size_t>(wrong.order)) > kTableauTolerance;
        // Stages used only by the error estimate or the next step.
        if (wrong.error_order)
          seen |= defect(wrong, embedded(wrong, wrong.error), size_t(wrong.error_order)) > kTableauTolerance;
        if (wrong.first_same_as_last() != m.tableau.first_same_as_last()) seen = true;
        EXPECT_TRUE(seen) << m.name << " a[" << i << "][" << j << "]";
      }
    }
  }
}

}  // namespace
}  // namespace truestep::test
