// Direct solution of symmetric block systems by A = P^T L D L^T P with b x b blocks, b = 1 or 3: rows are
// eliminated in a fill-reducing order (approximate minimum degree on the graph of blocks), one row of L at a
// time along the elimination tree (Davis 2006, "Direct methods for sparse linear systems", section 4.7, with
// scalars replaced by blocks). No pivoting: meant for positive definite matrices; an indefinite one usually
// factorises too, and `factorize` says when it does not.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/block_sparse.h"

namespace truestep {

class BlockLdlt {
 public:
  /// Order, elimination tree and fill of a pattern; does nothing if this pattern has been analysed already.
  /// Error "bad_pattern" unless the block size is 1 or 3.
  void analyze(const BlockSparse& a);
  /// Block products of a factorisation, after analyze.
  double work() const { return work_; }
  size_t fill_blocks() const { return column_begin_.empty() ? 0 : column_begin_.back(); }

  enum class Outcome : uint8_t { positive_definite, indefinite, singular };
  /// Factorises the values of `a` (its lower and upper half must agree; the lower one is read).
  Outcome factorize(const BlockSparse& a);
  /// x = A^-1 b after a nonsingular factorisation; x may be b.
  void solve(std::span<const double> b, std::span<double> x);
  /// Three right-hand sides of a matrix of single numbers at once, row by row: b and x are 3 per row.
  void solve_three(std::span<const double> b, std::span<double> x);

 private:
  template <int B>
  Outcome factorize_blocks(const BlockSparse& a);
  template <int B>
  void solve_blocks(std::span<const double> b, std::span<double> x);

  uint64_t stamp_ = 0;
  int block_size_ = 0;
  size_t n_ = 0;
  double work_ = 0;
  std::vector<uint32_t> order_, place_;  // order_[new] = old, place_[old] = new
  std::vector<int32_t> parent_;
  // Entries of A at or left of the diagonal, per new row: new column and slot in A.
  std::vector<uint32_t> row_begin_, row_column_;
  std::vector<BlockSparse::Slot> row_slot_;
  std::vector<size_t> column_begin_;
  std::vector<uint32_t> column_row_;
  std::vector<double, CacheLineAllocator<double>> lower_, inverse_, row_, rhs_;
  std::vector<uint32_t> filled_, stack_, mark_;
};

}  // namespace truestep
