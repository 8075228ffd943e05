// Square sparse matrix of small dense blocks, for Jacobians of point systems: block row i holds the blocks
// (i, j) of all points j that act on point i. The pattern is symmetric and always has the diagonal; values
// need not be symmetric. Compressed rows, columns ascending within a row.
//   y_i = sum_j A_ij x_j
// Block element (r, c) is at values()[b * b * slot + b * c + r]: column after column, because a 3 x 3
// product then runs over whole columns in one vector register.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/math/vec3.h"

namespace truestep {

class BlockSparse {
 public:
  using Slot = uint32_t;
  using Pair = std::array<uint32_t, 2>;

  /// Gives the matrix `block_rows` x `block_rows` blocks of `block_size` x `block_size` (1 to 6): the
  /// diagonal, every (i, j) of `pairs` and every (j, i). Duplicates are allowed; values become zero. Error
  /// "bad_pattern" when an index or the block size is out of range.
  void set_pattern(size_t block_rows, int block_size, std::span<const Pair> pairs);

  bool empty() const { return block_rows_ == 0; }
  int block_size() const { return block_size_; }
  size_t block_rows() const { return block_rows_; }
  size_t blocks() const { return columns_.size(); }
  /// Scalar rows: block_rows x block_size.
  size_t size() const { return block_rows_ * static_cast<size_t>(block_size_); }
  /// Changes with every set_pattern of any matrix; equal stamps mean equal patterns.
  uint64_t pattern_stamp() const { return stamp_; }

  /// Location of block (i, j); valid until the next set_pattern. Error "no_such_block" when it is not in the
  /// pattern. Costs a binary search: force fields look it up once and keep the slot.
  Slot slot(size_t i, size_t j) const;
  Slot diagonal_slot(size_t i) const { return diagonal_[i]; }
  /// Slots of block row i are row_begin(i) ... row_begin(i + 1) - 1.
  Slot row_begin(size_t i) const { return row_begin_[i]; }
  uint32_t column(Slot s) const { return columns_[s]; }

  /// All values, block after block (blocks() x b x b, each block column by column).
  std::span<double> values() { return {values_.data(), value_count()}; }
  std::span<const double> values() const { return {values_.data(), value_count()}; }
  /// The b x b numbers of one block, column by column.
  std::span<double> block(Slot s) { return values().subspan(s * block_scalars(), block_scalars()); }
  std::span<const double> block(Slot s) const {
    return values().subspan(s * block_scalars(), block_scalars());
  }
  /// Adds `scale` times the b x b numbers at `b` (column by column) to a block.
  void add_block(Slot s, const double* b, double scale = 1) {
    double* p = values_.data() + s * block_scalars();
    for (size_t k = 0; k < block_scalars(); ++k) p[k] += scale * b[k];
  }
  void set_zero();

  /// y = A x; both size() long, not overlapping. Rows in fixed blocks: the same bits on any number of
  /// threads.
  void multiply(std::span<const double> x, std::span<double> y, const ThreadArena& arena) const;
  /// y = A x for the block rows [begin, end) only.
  void multiply_rows(const double* x, double* y, size_t begin, size_t end) const;

 private:
  size_t block_scalars() const { return static_cast<size_t>(block_size_) * static_cast<size_t>(block_size_); }
  size_t value_count() const { return columns_.size() * block_scalars(); }

  size_t block_rows_ = 0;
  int block_size_ = 0;
  uint64_t stamp_ = 0;
  std::vector<Slot> row_begin_, diagonal_;
  std::vector<uint32_t> columns_;
  std::vector<double, CacheLineAllocator<double>> values_;  // three more than used: vector loads may overrun
};

}  // namespace truestep
