// Matrices of blocks as Eigen's: in a header of its own, for Eigen's are long.
#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "engine/math/block_sparse.h"

namespace truestep {

inline Eigen::SparseMatrix<double> to_eigen(const BlockSparse& matrix) {
  std::vector<Eigen::Triplet<double>> triplets;
  const auto b = static_cast<size_t>(matrix.block_size());
  for (size_t i = 0; i < matrix.block_rows(); ++i) {
    for (BlockSparse::Slot s = matrix.row_begin(i); s < matrix.row_begin(i + 1); ++s) {
      for (size_t k = 0; k < b * b; ++k) {
        triplets.emplace_back(static_cast<int>(i * b + k % b), static_cast<int>(matrix.column(s) * b + k / b),
                              matrix.block(s)[k]);
      }
    }
  }
  const auto size = static_cast<int>(matrix.size());
  Eigen::SparseMatrix<double> m(size, size);
  m.setFromTriplets(triplets.begin(), triplets.end());
  return m;
}

}  // namespace truestep
