#include "engine/math/block_sparse.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/lanes.h"

namespace truestep {

namespace {

// One block row of 3 x 3 blocks. Four lanes, the last one unused: three loads and three fused products per
// block. Separate sums per column shorten the dependency chain.
inline void row3(const double* values, const uint32_t* columns, size_t n, const double* x, double* y) {
  Lanes4 c0 = Lanes4::zero(), c1 = c0, c2 = c0;
  for (size_t s = 0; s < n; ++s) {
    const double* a = values + 9 * s;
    const double* xj = x + 3 * size_t{columns[s]};
    c0 = c0.plus(Lanes4::load(a), xj[0]);
    c1 = c1.plus(Lanes4::load(a + 3), xj[1]);
    c2 = c2.plus(Lanes4::load(a + 6), xj[2]);
  }
  store3(c0 + c1 + c2, y);
}

inline void row_any(int b, const double* values, const uint32_t* columns, size_t n, const double* x,
                    double* y) {
  for (int r = 0; r < b; ++r) {
    double sum = 0;
    for (size_t s = 0; s < n; ++s) {
      const double* a = values + s * static_cast<size_t>(b * b);
      const double* xj = x + size_t{columns[s]} * static_cast<size_t>(b);
      for (int c = 0; c < b; ++c) sum = std::fma(a[b * c + r], xj[c], sum);
    }
    y[r] = sum;
  }
}

}  // namespace

void BlockSparse::set_pattern(size_t block_rows, int block_size, std::span<const Pair> pairs) {
  if (block_size < 1 || block_size > 6 || block_rows >= UINT32_MAX) {
    throw Error("bad_pattern", "a block matrix needs blocks of 1 to 6 rows and fewer than 2^32 block rows");
  }
  for (const Pair& p : pairs) {
    if (p[0] >= block_rows || p[1] >= block_rows) {
      throw Error("bad_pattern", "a block of the pattern lies outside the matrix");
    }
  }
  static std::atomic<uint64_t> next_stamp{1};
  stamp_ = next_stamp.fetch_add(1);
  block_rows_ = block_rows;
  block_size_ = block_size;

  // Counting sort by row, then each short row by column.
  std::vector<Slot> begin(block_rows + 1, 0);
  for (const Pair& p : pairs) {
    ++begin[p[0] + 1];
    if (p[0] != p[1]) ++begin[p[1] + 1];
  }
  for (size_t i = 0; i < block_rows; ++i) begin[i + 1] += begin[i] + 1;
  std::vector<uint32_t> all(begin[block_rows]);
  std::vector<Slot> at(begin.begin(), begin.end() - 1);
  for (uint32_t i = 0; i < block_rows; ++i) all[at[i]++] = i;
  for (const Pair& p : pairs) {
    all[at[p[0]]++] = p[1];
    if (p[0] != p[1]) all[at[p[1]]++] = p[0];
  }
  columns_.clear();
  row_begin_.assign(1, 0);
  diagonal_.resize(block_rows);
  for (uint32_t i = 0; i < block_rows; ++i) {
    const auto first = all.begin() + begin[i], last = all.begin() + begin[i + 1];
    std::sort(first, last);
    for (auto it = first, end = std::unique(first, last); it != end; ++it) {
      if (*it == i) diagonal_[i] = static_cast<Slot>(columns_.size());
      columns_.push_back(*it);
    }
    row_begin_.push_back(static_cast<Slot>(columns_.size()));
  }
  values_.assign(value_count() + 3, 0.0);
}

BlockSparse::Slot BlockSparse::slot(size_t i, size_t j) const {
  if (i < block_rows_) {
    const auto first = columns_.begin() + row_begin_[i], last = columns_.begin() + row_begin_[i + 1];
    const auto it = std::lower_bound(first, last, j);
    if (it != last && *it == j) return static_cast<Slot>(it - columns_.begin());
  }
  throw Error("no_such_block",
              "block (" + std::to_string(i) + ", " + std::to_string(j) + ") is not in the pattern");
}

void BlockSparse::set_zero() {
  std::fill(values_.begin(), values_.end(), 0.0);
}

void BlockSparse::multiply_rows(const double* x, double* y, size_t begin, size_t end) const {
  const double* values = values_.data();
  const size_t bb = block_scalars();
  for (size_t i = begin; i < end; ++i) {
    const Slot s = row_begin_[i];
    const size_t n = row_begin_[i + 1] - s;
    switch (block_size_) {
      case 1:
        row_any(1, values + s, columns_.data() + s, n, x, y + i);
        break;
      case 3:
        row3(values + 9 * size_t{s}, columns_.data() + s, n, x, y + 3 * i);
        break;
      default:
        row_any(block_size_, values + bb * s, columns_.data() + s, n, x,
                y + i * static_cast<size_t>(block_size_));
    }
  }
}

void BlockSparse::multiply(std::span<const double> x, std::span<double> y, const ThreadArena& arena) const {
  arena.for_blocks(block_rows_, kBlockRows,
                   [&](size_t begin, size_t end) { multiply_rows(x.data(), y.data(), begin, end); });
}

}  // namespace truestep
