// Order conditions of the implicit methods' coefficients: all rooted trees up to their order, embedded
// weights, stability at infinity, and the transformation of Radau IIA. Rosenbrock methods: a node with one
// branch carries beta = alpha + gamma, one with several alpha (Hairer, Wanner 1996, theorem IV.7.3).
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "engine/integrators/implicit/dirk_tableau.h"
#include "engine/integrators/implicit/radau5_coefficients.h"
#include "engine/integrators/implicit/rosenbrock_tableau.h"
#include "tests/support/rooted_trees.h"

namespace truestep::test {
namespace {

// Exact coefficients leave rounding; those of Rodas5P are given to 16 digits, up to 150 in size, and enter
// products of four.
constexpr double kExact = 1e-14, kPublished = 2e-12;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Largest defect of b against all trees up to `order`.
double defect(const Matrix& alone, const Matrix& several, const Vector& b, size_t order) {
  const auto trees = first_order_trees(order);
  std::vector<Vector> phi;
  std::vector<double> exact;
  double worst = 0;
  for (const RootedTree& t : trees) {
    Vector p = Vector::Ones(b.size());
    double e = 1;
    for (const size_t s : t.subtrees) {
      p = p.cwiseProduct((t.subtrees.size() == 1 ? alone : several) * phi[s]);
      e *= exact[s] / double(trees[s].order);
    }
    worst = std::max(worst, std::abs(b.dot(p) - e / double(t.order)));
    phi.push_back(p), exact.push_back(e);
  }
  return worst;
}

struct RungeKuttaCoefficients {
  Matrix a;
  Vector b, c, error;
};
RungeKuttaCoefficients coefficients(const DirkTableau& t) {
  const auto s = long(t.stages);
  RungeKuttaCoefficients r{Matrix(s, s), Vector(s), Vector(s), Vector(s)};
  for (long i = 0; i < s; ++i) {
    r.b[i] = t.b[size_t(i)], r.c[i] = t.c[size_t(i)], r.error[i] = t.error[size_t(i)];
    for (long j = 0; j < s; ++j) r.a(i, j) = t.a[size_t(i)][size_t(j)];
  }
  return r;
}

struct Named {
  const char* name;
  const DirkTableau& tableau;
};
constexpr Named kDirk[] = {{"sdirk4", kSdirk4},
                           {"tr_bdf2", kTrBdf2},
                           {"implicit_midpoint", kImplicitMidpoint},
                           {"trapezoid", kTrapezoid}};

TEST(DirkTableaus, SatisfyAllTreesUpToTheirOrderAndNoMore) {
  for (const Named& m : kDirk) {
    const auto r = coefficients(m.tableau);
    const auto order = size_t(m.tableau.order);
    EXPECT_LT(defect(r.a, r.a, r.b, order), kExact) << m.name;
    EXPECT_GT(defect(r.a, r.a, r.b, order + 1), 1e-3) << m.name;
    EXPECT_LT((r.a * Vector::Ones(r.b.size()) - r.c).cwiseAbs().maxCoeff(), kExact) << m.name;
    for (long i = m.tableau.explicit_first() ? 1 : 0; i < r.b.size(); ++i)
      EXPECT_EQ(r.a(i, i), m.tableau.gamma);
    if (m.tableau.error_order == 0) continue;
    // Both embedded methods are of order 3: below sdirk4, above tr_bdf2.
    const Vector embedded = r.b - r.error;
    EXPECT_LT(defect(r.a, r.a, embedded, 3), kExact) << m.name;
    EXPECT_GT(defect(r.a, r.a, embedded, 4), 1e-3) << m.name;
  }
}

TEST(DirkTableaus, VanishAtInfinityWherePromised) {
  // R(z) = 1 + z b (I - z A)^-1 1 at z = -1e8: below 1e-6 when L-stable, 1 in size for the two symmetric
  // ones.
  const auto far = [](const DirkTableau& t) {
    const auto r = coefficients(t);
    const double z = -1e8;
    const Matrix m = Matrix::Identity(r.b.size(), r.b.size()) - z * r.a;
    return 1 + z * r.b.dot(m.fullPivLu().solve(Vector::Ones(r.b.size())));
  };
  EXPECT_NEAR(far(kSdirk4), 0, 1e-6);
  EXPECT_NEAR(far(kTrBdf2), 0, 1e-6);
  EXPECT_NEAR(far(kImplicitMidpoint), -1, 1e-6);
  EXPECT_NEAR(far(kTrapezoid), -1, 1e-6);
}

struct Rosenbrock {
  Matrix alpha, beta, gamma;
  Vector b, embedded;
};
// Back from the form without Jacobian products: Gamma^-1 = I/gamma - C, alpha = a Gamma, b = m Gamma.
Rosenbrock original(const RosenbrockTableau& t) {
  const auto s = long(t.stages);
  Matrix a(s, s), c(s, s);
  Vector m(s), e(s);
  for (long i = 0; i < s; ++i) {
    m[i] = t.m[size_t(i)], e[i] = t.e[size_t(i)];
    for (long j = 0; j < s; ++j) a(i, j) = t.a[size_t(i)][size_t(j)], c(i, j) = t.c[size_t(i)][size_t(j)];
  }
  const Matrix gamma = (Matrix::Identity(s, s) / t.gamma - c).inverse();
  const Matrix alpha = a * gamma;
  return {alpha, alpha + gamma, gamma, gamma.transpose() * m, gamma.transpose() * (m - e)};
}

TEST(RosenbrockTableaus, Rodas5pSatisfiesItsConditions) {
  const Rosenbrock r = original(kRodas5p);
  EXPECT_LT(defect(r.beta, r.alpha, r.b, 5), kPublished);
  EXPECT_GT(defect(r.beta, r.alpha, r.b, 6), 1e-5);
  EXPECT_LT(defect(r.beta, r.alpha, r.embedded, 4), kPublished);
  EXPECT_GT(defect(r.beta, r.alpha, r.embedded, 5), 1e-5);
  for (long i = 0; i < r.b.size(); ++i) {
    EXPECT_NEAR(r.alpha.row(i).sum(), kRodas5p.alpha[size_t(i)], kPublished) << i;
    EXPECT_NEAR(r.gamma.row(i).sum(), kRodas5p.d[size_t(i)], kPublished) << i;
  }
  // Stiffly accurate: the last row of beta is b, alpha_s = 1.
  EXPECT_LT((r.beta.row(7).transpose() - r.b).cwiseAbs().maxCoeff(), kPublished);
  const Matrix m = Matrix::Identity(8, 8) + 1e8 * r.beta;
  EXPECT_NEAR(1 - 1e8 * r.b.dot(m.fullPivLu().solve(Vector::Ones(8))), 0, 1e-5);
}

TEST(RosenbrockTableaus, AChangedDigitFails) {
  RosenbrockTableau wrong = kRodas5p;
  wrong.c[4][2] += 1e-6;
  const Rosenbrock r = original(wrong);
  EXPECT_GT(defect(r.beta, r.alpha, r.b, 5), 100 * kPublished);
}

TEST(RosenbrockTableaus, DenseOutputKeepsOrderFour) {
  // Weights of y(theta) satisfy the conditions with theta^rho in place of 1.
  const Rosenbrock r = original(kRodas5p);
  const double theta = 0.37;
  Vector k[3];
  for (int q = 0; q < 3; ++q) {
    k[q] = Vector(8);
    for (long j = 0; j < 8; ++j) k[q][j] = kRodas5p.dense[size_t(q)][size_t(j)];
  }
  Vector m(8);
  for (long j = 0; j < 8; ++j) m[j] = kRodas5p.m[size_t(j)];
  const Vector at = theta * (m + (1 - theta) * (k[0] + theta * (k[1] + theta * k[2])));
  const Vector b = r.gamma.transpose() * at;
  const auto trees = first_order_trees(5);
  std::vector<Vector> phi;
  std::vector<double> exact;
  double worst_four = 0, worst_five = 0;
  for (const RootedTree& t : trees) {
    Vector p = Vector::Ones(8);
    double e = 1;
    for (const size_t s : t.subtrees) {
      p = p.cwiseProduct((t.subtrees.size() == 1 ? r.beta : r.alpha) * phi[s]);
      e *= exact[s] / double(trees[s].order);
    }
    const double d = std::abs(b.dot(p) - e / double(t.order) * std::pow(theta, double(t.order)));
    (t.order <= 4 ? worst_four : worst_five) = std::max(t.order <= 4 ? worst_four : worst_five, d);
    phi.push_back(p), exact.push_back(e);
  }
  EXPECT_LT(worst_four, kPublished);
  EXPECT_GT(worst_five, 1e-6);
}

TEST(Radau5, CoefficientsAndTransformation) {
  using namespace radau5;
  Eigen::Matrix3d a, t, inverse;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      a(i, j) = kA[size_t(i)][size_t(j)], t(i, j) = kT[size_t(i)][size_t(j)];
      inverse(i, j) = kInverseT[size_t(i)][size_t(j)];
    }
  }
  const Vector b = a.row(2).transpose();
  EXPECT_LT(defect(a, a, b, 5), kExact);
  EXPECT_GT(defect(a, a, b, 6), 1e-5);
  // Collocation: sum_j a_ij c_j^(k-1) = c_i^k / k for k = 1, 2, 3.
  const Eigen::Vector3d c(kC1, kC2, 1);
  for (int k = 1; k <= 3; ++k) {
    const Eigen::Vector3d left = a * c.array().pow(k - 1).matrix(), right = c.array().pow(k).matrix() / k;
    EXPECT_LT((left - right).cwiseAbs().maxCoeff(), kExact);
  }
  EXPECT_LT((t * inverse - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), kExact);
  const Eigen::Matrix3d split = inverse * a * t;
  Eigen::Matrix3d want = Eigen::Matrix3d::Zero();
  want(0, 0) = kInverseGamma;
  // The inverse of (a -b; b a) is (re -im; im re) of 1/(a + i b).
  want(1, 1) = want(2, 2) = kInverse.re, want(1, 2) = -kInverse.im, want(2, 1) = kInverse.im;
  EXPECT_LT((split - want).cwiseAbs().maxCoeff(), kExact);
}

}  // namespace
}  // namespace truestep::test
