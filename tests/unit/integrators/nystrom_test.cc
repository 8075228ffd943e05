// Nystroem pairs, splittings and the Gauss-Radau rows satisfy the order conditions of their promised order. A
// splitting is a Nystroem method too: K_i = a(x + h c_i v + h^2 sum_j k_j (c_i - c_j) K_j).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/explicit/tableau_nystrom.h"
#include "engine/integrators/symplectic/splitting.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_problems.h"
#include "tests/support/rooted_trees.h"

namespace truestep::test {
namespace {

// For products of coefficients around 1 with 17 digits.
constexpr double kTolerance = 2e-14;

NystromTableau as_tableau(const Splitting& s) {
  NystromTableau t;
  t.stages = s.kicks, t.order = s.order;
  double place = 0;
  for (size_t i = 0; i < s.kicks; ++i) {
    place += s.drift[i];
    t.c[i] = place, t.bv[i] = s.kick[i], t.b[i] = s.kick[i] * (1 - place);
    for (size_t j = 0; j < i; ++j) t.a[i][j] = s.kick[j] * (place - t.c[j]);
  }
  return t;
}

// Largest defect of the conditions on velocity up to `order` and on position up to the same.
double defect(const NystromTableau& t, const NystromTableau::Weights& b, const NystromTableau::Weights& bv,
              size_t order) {
  const auto trees = second_order_trees(order);
  const auto w = elementary_weights(
      trees, t.stages, [&](size_t i, size_t l) { return t.a[i][l]; }, [&](size_t i) { return t.c[i]; }, 2);
  double worst = 0;
  for (size_t k = 0; k < trees.size(); ++k) {
    const auto rho = static_cast<double>(trees[k].order);
    double velocity = -w.exact[k] / rho, position = -w.exact[k] / (rho * (rho + 1));
    for (size_t i = 0; i < t.stages; ++i) {
      velocity += bv[i] * w.stages[k][i], position += b[i] * w.stages[k][i];
    }
    worst = std::max(worst, std::abs(velocity));
    if (trees[k].order < order) worst = std::max(worst, std::abs(position));
  }
  return worst;
}
double defect(const NystromTableau& t, size_t order) {
  return defect(t, t.b, t.bv, order);
}

struct NamedNystrom {
  const char* name;
  NystromTableau tableau;
};
std::vector<NamedNystrom> all() {
  return {{"rkn86", kRkn86Tableau},
          {"rkn1210", kRkn1210Tableau},
          {"leapfrog", as_tableau(kLeapfrog)},
          {"yoshida4", as_tableau(kYoshida4)},
          {"yoshida6", as_tableau(kYoshida6)},
          {"yoshida8", as_tableau(kYoshida8)},
          {"kahan_li8", as_tableau(kKahanLi8)},
          {"pefrl", as_tableau(kPefrl)}};
}

TEST(Nystrom, OrderConditionsHoldAndNoMore) {
  for (const NamedNystrom& m : all()) {
    const auto order = static_cast<size_t>(m.tableau.order);
    EXPECT_EQ(find_integrator(m.name)->order, m.tableau.order);
    EXPECT_LT(defect(m.tableau, order), kTolerance) << m.name;
    EXPECT_GT(defect(m.tableau, order + 1), 1e-9) << m.name << " promises too little";
  }
}

TEST(Nystrom, EmbeddedSolutionsHaveTheirOrders) {
  for (const NystromTableau& t : {kRkn86Tableau, kRkn1210Tableau}) {
    auto b = t.b, bv = t.bv;
    for (size_t i = 0; i < t.stages; ++i) b[i] -= t.error[i], bv[i] -= t.error_v[i];
    const auto order = static_cast<size_t>(t.error_order);
    EXPECT_LT(defect(t, b, bv, order), kTolerance);
    EXPECT_GT(defect(t, b, bv, order + 1), 1e-8);
    for (size_t i = 0; i < t.stages; ++i) {
      double sum = 0;
      for (size_t j = 0; j < i; ++j) sum += t.a[i][j];
      EXPECT_NEAR(sum, 0.5 * t.c[i] * t.c[i], kTolerance) << "row " << i;
    }
  }
  EXPECT_TRUE(kRkn86Tableau.first_same_as_last());
  EXPECT_FALSE(kRkn1210Tableau.first_same_as_last());
}

TEST(Nystrom, AChangedDigitFails) {
  for (const NamedNystrom& m : all()) {
    for (size_t i = 0; i < m.tableau.stages; ++i) {
      NystromTableau wrong = m.tableau;
      wrong.bv[i] += 1e-9;
      EXPECT_GT(defect(wrong, static_cast<size_t>(wrong.order)), 10 * kTolerance)
          << m.name << " bv[" << i << "]";
    }
    NystromTableau wrong = m.tableau;
    if (m.tableau.stages > 2) {
      wrong.a[2][1] += 1e-7;
      EXPECT_GT(defect(wrong, static_cast<size_t>(wrong.order)), 10 * kTolerance) << m.name;
    }
  }
}

// x'' = t^k, whose velocity a quadrature of order 15 finds exactly up to k = 14.
class Power final : public RightHandSide, public SecondOrder {
 public:
  explicit Power(int k) : k_(k) {}
  size_t size() const override { return 2; }
  void rate(double t, const double* y, double* d) const override {
    d[0] = y[1];
    acceleration(t, y, y + 1, d + 1);
  }
  const SecondOrder* second_order() const override { return this; }
  void acceleration(double t, const double*, const double*, double* a) const override {
    a[0] = 1;
    for (int i = 0; i < k_; ++i) a[0] *= t;
  }
  bool depends_on_velocity() const override { return false; }

 private:
  int k_;
};

TEST(Ias15, NodesAreGaussRadau) {
  for (int k = 0; k <= 15; ++k) {
    const Power f(k);
    Workspace workspace;
    Carry carry{.step = 1};
    double y[2] = {0, 0};
    Advance in{.f = f,
               .t = 0,
               .t_end = 1,
               .y = y,
               .workspace = workspace,
               .carry = carry,
               .tolerance = {.relative = 0, .absolute = 1e300}};
    find_integrator("ias15")->advance(in);
    // Coefficients around 10 cancel, which leaves a few 1e-15; degree 15 misses by 2.6e-9.
    const double error = std::abs(y[1] - 1.0 / (k + 1));
    EXPECT_EQ(error < 2e-14, k <= 14) << "degree " << k << ": " << error;
  }
}

}  // namespace
}  // namespace truestep::test
