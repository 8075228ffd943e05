#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>

#include "engine/base/random.h"
#include "engine/math/solvers/block_solver.h"

namespace truestep {
namespace {

// A ring with long chords; s I + sum of positive semidefinite links, or its shifted, indefinite relative.
BlockSparse network(uint32_t rows, int b, double diagonal) {
  std::vector<BlockSparse::Pair> pairs;
  for (uint32_t i = 0; i < rows; ++i) {
    pairs.push_back({i, (i + 1) % rows});
    pairs.push_back({i, (i * 7 + 3) % rows});
  }
  BlockSparse m;
  m.set_pattern(rows, b, pairs);
  const auto width = static_cast<size_t>(b);
  uint64_t n = 0;
  for (const auto& [i, j] : pairs) {
    if (i == j) continue;
    const auto d = uniform4(11, 0, n++);
    std::vector<double> block(width * width);
    for (size_t c = 0; c < width; ++c) {
      for (size_t r = 0; r < width; ++r)
        block[c * width + r] = (d[r] - 0.5) * (d[c] - 0.5) + (r == c ? 0.1 : 0);
    }
    m.add_block(m.diagonal_slot(i), block.data());
    m.add_block(m.diagonal_slot(j), block.data());
    m.add_block(m.slot(i, j), block.data(), -1);
    m.add_block(m.slot(j, i), block.data(), -1);
  }
  for (size_t i = 0; i < rows; ++i) {
    for (size_t k = 0; k < width; ++k) m.block(m.diagonal_slot(i))[k * width + k] += diagonal;
  }
  return m;
}

std::vector<double> numbers(size_t n) {
  std::vector<double> v(n);
  for (size_t i = 0; i < n; ++i) v[i] = uniform4(12, 0, i)[0] - 0.5;
  return v;
}

double error_of(const BlockSparse& a, const std::vector<double>& b, const std::vector<double>& x) {
  std::vector<double> ax(x.size());
  a.multiply(x, ax, ThreadArena(1));
  double worst = 0;
  for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(ax[i] - b[i]));
  return worst;
}

TEST(BlockLdlt, SolvesDefiniteAndIndefiniteSystems) {
  for (const int b : {1, 3}) {
    for (const double diagonal : {0.01, -0.07}) {
      const BlockSparse a = network(400, b, diagonal);
      const auto rhs = numbers(a.size());
      std::vector<double> x(a.size());
      BlockLdlt ldlt;
      const auto outcome = ldlt.factorize(a);
      EXPECT_EQ(outcome,
                diagonal > 0 ? BlockLdlt::Outcome::positive_definite : BlockLdlt::Outcome::indefinite);
      ldlt.solve(rhs, x);
      // Without pivoting an indefinite matrix may lose a few digits more.
      EXPECT_LT(error_of(a, rhs, x), diagonal > 0 ? 1e-12 : 1e-8) << "block size " << b;
      // Again with the cached analysis, and with another matrix of the same pattern in between.
      BlockSparse other = a;
      for (double& v : other.values()) v *= 2;
      ldlt.factorize(other);
      ldlt.factorize(a);
      std::vector<double> again(a.size());
      ldlt.solve(rhs, again);
      EXPECT_EQ(x, again);
    }
  }
}

TEST(BlockLdlt, SaysWhenAMatrixIsSingular) {
  BlockSparse a;
  a.set_pattern(4, 3, {});
  EXPECT_EQ(BlockLdlt().factorize(a), BlockLdlt::Outcome::singular);
}

TEST(Pcg, SolvesAndDoesNotDependOnThreads) {
  const BlockSparse a = network(3000, 3, 0.05);
  const auto rhs = numbers(a.size());
  std::vector<double> one(a.size()), three(a.size());
  Pcg pcg;
  const auto r = pcg.solve(a, rhs, one, 1e-12, 1000, ThreadArena(1));
  EXPECT_EQ(r.outcome, Pcg::Outcome::converged);
  EXPECT_LT(error_of(a, rhs, one), 1e-10);
  pcg.solve(a, rhs, three, 1e-12, 1000, ThreadArena(3));
  EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof(double)), 0);
  // Control: a solve that stops early is not accurate.
  EXPECT_EQ(pcg.solve(a, rhs, one, 1e-12, 5, ThreadArena(1)).outcome, Pcg::Outcome::out_of_iterations);
  EXPECT_GT(error_of(a, rhs, one), 1e-6);
}

TEST(Pcg, ReportsNegativeCurvature) {
  const BlockSparse a = network(300, 3, -0.5);
  std::vector<double> x(a.size());
  EXPECT_EQ(Pcg().solve(a, numbers(a.size()), x, 1e-10, 1000, ThreadArena(1)).outcome,
            Pcg::Outcome::negative_curvature);
}

TEST(BlockSolver, AgreesWithADenseSolutionWhicheverMethodItTakes) {
  for (const double diagonal : {1.0, 1e-3, -0.07}) {
    const BlockSparse a = network(200, 3, diagonal);
    const auto rhs = numbers(a.size());
    std::vector<double> x(a.size());
    BlockSolver solver;
    for (const auto symmetry : {BlockSolver::Symmetry::symmetric, BlockSolver::Symmetry::general}) {
      const auto result = solver.solve(
          a, rhs, x, {.tolerance = 1e-12, .condition = 4 / std::abs(diagonal), .symmetry = symmetry},
          ThreadArena(1));
      EXPECT_TRUE(result.solved);
      EXPECT_LT(error_of(a, rhs, x), 1e-8) << diagonal;
    }
  }
}

}  // namespace
}  // namespace truestep
