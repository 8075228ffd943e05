// The largest value of a parallel loop over fixed blocks: the same for any number of threads, without memory.
#pragma once
#include <atomic>

#include "engine/base/parallel.h"

namespace truestep {

/// Largest of 0 and body(begin, end) over all blocks of at most `block` of [0, n); not a number if a block
/// says so.
template <class Body>
double largest_block(const ThreadArena& arena, size_t n, size_t block, Body&& body) {
  std::atomic<double> most = 0;
  arena.for_blocks(n, block, [&](size_t begin, size_t end) {
    const double own = body(begin, end);
    double seen = most.load(std::memory_order_relaxed);
    while (seen == seen && !(own <= seen) &&
           !most.compare_exchange_weak(seen, own, std::memory_order_relaxed)) {
    }
  });
  return most;
}

}  // namespace truestep
