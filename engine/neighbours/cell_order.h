// Points in the order of the cells that contain them: a counting sort by (cell, index), so that the order is
// a function of the cells alone, whatever the number of threads. Several threads first sort points by ranges
// of cells, in parts, then each range by itself. Allocates only when there are more points or cells than
// before.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/base/parallel.h"

namespace truestep {

class CellOrder {
 public:
  /// In place of a cell: the point has no slot.
  static constexpr uint32_t kNone = 0xffffffff;

  /// Memory for this many.
  void reserve(size_t points, size_t cells) {
    cell_.reserve(points), order_.reserve(points), start_.reserve(cells + 1);
  }
  /// Sorts n points into `cells` (at least 1, below 2^31). cell_of(i) is the cell of point i, or kNone;
  /// several threads may call it.
  template <class CellOf>
  void sort(size_t n, size_t cells, const CellOf& cell_of, const ThreadArena& arena) {
    divide(n, cells, arena.threads());
    arena.for_blocks(n, part_, [&](size_t begin, size_t end) {
      uint32_t* const count = cursors_.data() + begin / part_ * ranges_;
      for (size_t i = begin; i < end; ++i) {
        const auto c = static_cast<uint32_t>(cell_of(i));
        cell_[i] = c;
        if (c != kNone) ++count[c >> shift_];
      }
    });
    arrange(arena);
  }

  /// Number of slots: of points that have a cell.
  size_t size() const { return order_.size(); }
  /// Index of the point in a slot.
  uint32_t point(size_t slot) const { return order_[slot]; }
  /// First slot of a cell; of the cell after the last, the number of slots.
  uint32_t start(size_t cell) const { return start_[cell]; }

 private:
  void divide(size_t n, size_t cells, int threads);
  void arrange(const ThreadArena& arena);
  void arrange_range(size_t range);

  size_t part_ = 1, ranges_ = 1;  ///< points that are counted together; ranges of cells
  unsigned shift_ = 0;            ///< a range has 2^shift_ cells
  std::vector<uint32_t> start_, order_, cell_;
  std::vector<uint32_t> cursors_;      ///< by part and range
  std::vector<uint32_t> range_start_;  ///< slots
  std::vector<uint32_t> by_range_;     ///< points in the order of ranges, where there are several
};

}  // namespace truestep
