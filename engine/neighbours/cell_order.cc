#include "engine/neighbours/cell_order.h"

#include <algorithm>
#include <utility>

namespace truestep {

void CellOrder::divide(size_t n, size_t cells, int threads) {
  // Enough ranges that a crowded one is no bottleneck, few enough that a part's cursors stay in the cache.
  constexpr size_t kMostRanges = 128, kParts = 8;
  const bool together = threads <= 1 || n < 2 * kBlockRows;
  part_ = together ? std::max(n, size_t{1}) : (n + kParts - 1) / kParts;
  shift_ = 31;
  if (!together) {
    shift_ = 0;
    while ((cells - 1) >> shift_ >= kMostRanges) ++shift_;
  }
  ranges_ = ((cells - 1) >> shift_) + 1;
  cell_.resize(n), start_.resize(cells + 1), range_start_.resize(ranges_ + 1);
  cursors_.assign((n + part_ - 1) / part_ * ranges_, 0);
  if (!together) by_range_.reserve(cell_.capacity());
}

void CellOrder::arrange(const ThreadArena& arena) {
  // Counts become the first slots of each part's points in each range.
  uint32_t next = 0;
  for (size_t r = 0; r < ranges_; ++r) {
    range_start_[r] = next;
    for (size_t k = r; k < cursors_.size(); k += ranges_) next += std::exchange(cursors_[k], next);
  }
  range_start_[ranges_] = start_.back() = next;
  order_.resize(next);
  if (ranges_ == 1) {
    arrange_range(0);
    return;
  }
  by_range_.resize(next);
  arena.for_blocks(cell_.size(), part_, [&](size_t begin, size_t end) {
    uint32_t* const at = cursors_.data() + begin / part_ * ranges_;
    for (size_t i = begin; i < end; ++i) {
      if (cell_[i] != kNone) by_range_[at[cell_[i] >> shift_]++] = static_cast<uint32_t>(i);
    }
  });
  arena.for_blocks(ranges_, 1, [&](size_t r, size_t) { arrange_range(r); });
}

void CellOrder::arrange_range(size_t range) {
  const size_t low = range << shift_, high = std::min((range + 1) << shift_, start_.size() - 1);
  uint32_t* const start = start_.data();
  const auto each = [&](const auto& visit) {
    if (ranges_ == 1) {
      for (size_t i = 0; i < cell_.size(); ++i) {
        if (cell_[i] != kNone) visit(static_cast<uint32_t>(i));
      }
    } else {
      for (size_t k = range_start_[range]; k < range_start_[range + 1]; ++k) visit(by_range_[k]);
    }
  };
  std::fill(start + low, start + high, 0u);
  each([&](uint32_t i) { ++start[cell_[i]]; });
  uint32_t next = range_start_[range];
  for (size_t c = low; c < high; ++c) next += std::exchange(start[c], next);
  each([&](uint32_t i) { order_[start[cell_[i]]++] = i; });
  // Filling moved each cell's start to its end, which is the next one's start.
  for (size_t c = high - 1; c > low; --c) start[c] = start[c - 1];
  start[low] = range_start_[range];
}

}  // namespace truestep
