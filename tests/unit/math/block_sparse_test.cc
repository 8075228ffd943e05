#include "engine/math/block_sparse.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "tests/support/block_sparse_eigen.h"

namespace truestep {
namespace {

struct Sample {
  BlockSparse matrix;
  std::vector<double> x;
};

Sample sample(size_t rows, int b) {
  std::vector<BlockSparse::Pair> pairs;
  for (uint32_t i = 0; i < rows; ++i) {
    const auto r = uniform4(1, 2, i);
    for (int k = 0; k < 3; ++k) pairs.push_back({i, static_cast<uint32_t>(r[k] * double(rows))});
  }
  Sample s;
  s.matrix.set_pattern(rows, b, pairs);
  uint64_t n = 0;
  for (double& v : s.matrix.values()) v = uniform4(3, 4, n++)[0] - 0.5;
  s.x.resize(s.matrix.size());
  for (double& v : s.x) v = uniform4(3, 5, n++)[0] - 0.5;
  return s;
}

TEST(BlockSparse, MultipliesLikeEigen) {
  const ThreadArena serial(1);
  for (const int b : {1, 2, 3, 4, 6}) {
    const Sample s = sample(301, b);
    std::vector<double> y(s.x.size());
    s.matrix.multiply(s.x, y, serial);
    const Eigen::VectorXd expected =
        to_eigen(s.matrix) * Eigen::Map<const Eigen::VectorXd>(s.x.data(), Eigen::Index(s.x.size()));
    double worst = 0;
    for (size_t i = 0; i < y.size(); ++i) worst = std::max(worst, std::abs(y[i] - expected[Eigen::Index(i)]));
    // At most some 60 products below 1/4 are added per row: 60 roundings of 1e-16.
    EXPECT_LT(worst, 1e-14) << "block size " << b;
    if (b > 1) {
      // The same numbers read by rows instead of columns must not pass.
      BlockSparse transposed = s.matrix;
      for (BlockSparse::Slot k = 0; k < transposed.blocks(); ++k) {
        std::swap(transposed.block(k)[1], transposed.block(k)[size_t(b)]);
      }
      transposed.multiply(s.x, y, serial);
      worst = 0;
      for (size_t i = 0; i < y.size(); ++i) {
        worst = std::max(worst, std::abs(y[i] - expected[Eigen::Index(i)]));
      }
      EXPECT_GT(worst, 1e-2);
    }
  }
}

TEST(BlockSparse, ThreadsDoNotChangeABit) {
  const Sample s = sample(10000, 3);
  std::vector<double> one(s.x.size()), four(s.x.size());
  s.matrix.multiply(s.x, one, ThreadArena(1));
  s.matrix.multiply(s.x, four, ThreadArena(4));
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(double)), 0);
}

TEST(BlockSparse, PatternIsSymmetricWithDiagonalAndSlotsFindTheirBlocks) {
  BlockSparse m;
  const std::vector<BlockSparse::Pair> pairs = {{0, 3}, {3, 0}, {2, 1}, {1, 1}};
  m.set_pattern(4, 2, pairs);
  EXPECT_EQ(m.blocks(), 8u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(m.slot(i, i), m.diagonal_slot(i));
    for (BlockSparse::Slot s = m.row_begin(i); s < m.row_begin(i + 1); ++s) {
      EXPECT_EQ(m.slot(i, m.column(s)), s);
      EXPECT_NO_THROW(m.slot(m.column(s), i));
    }
  }
  EXPECT_THROW(m.slot(0, 1), Error);
  EXPECT_THROW(m.slot(9, 0), Error);
}

TEST(BlockSparse, RefusesIndicesOutsideTheMatrix) {
  BlockSparse m;
  const std::vector<BlockSparse::Pair> pairs = {{0, 4}};
  EXPECT_THROW(m.set_pattern(4, 3, pairs), Error);
  EXPECT_THROW(m.set_pattern(4, 7, {}), Error);
}

}  // namespace
}  // namespace truestep
