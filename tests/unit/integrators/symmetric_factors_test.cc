// Symmetric factors of an implicit system return what a sparse LU returns, also beside rows that are held,
// and leave matrices that need pivots to it.
#include "engine/integrators/linear/symmetric_factors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/linear/sparse_factors.h"

namespace truestep {
namespace {

// A net of side x side points in blocks of 3: A = W K with K = -stiff times the graph's Laplacian plus
// something random and symmetric in every block; row by row divided by masses of 1 to 8.
struct LinkedNet {
  size_t points, n;
  std::vector<int32_t> start{0}, rows;
  std::vector<double> inverse_mass, a;

  LinkedNet(size_t side, double stiff, size_t held) : points(side * side), n(3 * points) {
    for (size_t i = 0; i < points; ++i) inverse_mass.push_back(i < held ? 0 : 1 / (1 + double(i % 8)));
    for (size_t j = 0; j < points; ++j) {
      for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < points; ++i) {
          const size_t dx = std::max(i % side, j % side) - std::min(i % side, j % side);
          const size_t dy = std::max(i / side, j / side) - std::min(i / side, j / side);
          if (dx + dy > 1) continue;
          for (size_t r = 0; r < 3; ++r) {
            const size_t row = 3 * i + r, column = 3 * j + c;
            const double noise = 0.1 * std::sin(double(std::min(row, column) + 7 * std::max(row, column)));
            const double laplacian = r != c ? 0 : i == j ? -4 : 1;
            rows.push_back(int32_t(row));
            a.push_back(inverse_mass[i] * stiff * (laplacian + noise));
          }
        }
        start.push_back(int32_t(rows.size()));
      }
    }
  }
  std::vector<double> numbers() const {
    std::vector<double> b(n);
    for (size_t k = 0; k < n; ++k) b[k] = std::cos(0.7 * double(k));
    return b;
  }
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

// Conditions are below 1e3, so both solutions are good to 1e-12. Control: with other masses the matrix is not
// the one that is solved, and the difference is of the size of the solution.
TEST(SymmetricFactors, SolveWhatTheSparseLuSolves) {
  for (const size_t held : {size_t{0}, size_t{5}}) {
    const LinkedNet net(7, 30, held);
    SparseFactors lu(net.n, net.start, net.rows);
    ASSERT_TRUE(lu.factor(net.a.data(), net.a.data(), 0.6, 0.4));
    SymmetricFactors symmetric(net.n, net.start, net.rows);
    ASSERT_TRUE(symmetric.factor(net.a.data(), net.a.data(), 0.6, 0.4, net.inverse_mass));
    std::vector<double> x = net.numbers(), y = x, z = x;
    lu.solve(x.data()), symmetric.solve(y.data());
    EXPECT_LT(largest_difference(x, y), 1e-12) << held;
    ASSERT_TRUE(symmetric.factor(net.a.data(), net.a.data(), 0.6, 0.41, net.inverse_mass));
    symmetric.solve(z.data());
    EXPECT_GT(largest_difference(x, z), 1e-4) << held;
  }
}

// I - c A with a first block of zeros: the elimination has nothing to begin with, although the matrix is far
// from singular. Whoever asks gets the LU instead.
TEST(SymmetricFactors, WhatNeedsPivotsIsLeftToTheLu) {
  LinkedNet net(2, 0, 0);
  for (size_t j = 0; j < net.n; ++j) {
    for (int32_t k = net.start[j]; k < net.start[j + 1]; ++k) {
      const auto row = size_t(net.rows[size_t(k)]);
      net.inverse_mass[row / 3] = 1;
      net.a[size_t(k)] = row == j ? 1 : row % 3 == j % 3 ? 2 + double(row / 3 + j / 3) : 0;
    }
  }
  SymmetricFactors symmetric(net.n, net.start, net.rows);
  EXPECT_FALSE(symmetric.factor(net.a.data(), nullptr, 1, 0, net.inverse_mass));
  SparseFactors factors(net.n, net.start, net.rows);
  ASSERT_TRUE(factors.factor(net.a.data(), nullptr, 1, 0, net.inverse_mass));
  const std::vector<double> b = net.numbers();
  std::vector<double> x = b, product(net.n);
  factors.solve(x.data());
  for (size_t j = 0; j < net.n; ++j) {
    product[j] += x[j];
    for (int32_t k = net.start[j]; k < net.start[j + 1]; ++k) {
      product[size_t(net.rows[size_t(k)])] -= net.a[size_t(k)] * x[j];
    }
  }
  EXPECT_LT(largest_difference(product, b), 1e-12);
}

}  // namespace
}  // namespace truestep
