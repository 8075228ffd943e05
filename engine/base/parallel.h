// Parallel loops with a fixed decomposition: the blocks depend only on n and the block size, never on the
// number of threads, so every sum comes out with the same bits. oneTBB underneath.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "engine/base/interrupt.h"

namespace truestep {

/// The threads that a session may use. 0 or 1 means: run in the caller. Cheap to hold while idle.
class ThreadArena {
 public:
  explicit ThreadArena(int threads = 1);
  ~ThreadArena();
  ThreadArena(const ThreadArena&) = delete;
  ThreadArena& operator=(const ThreadArena&) = delete;
  int threads() const { return threads_; }

  /// body(begin, end) for every block of at most `block` elements of [0, n). Blocks may run concurrently. The
  /// caller's work may be interrupted before the loop.
  template <class Body>
  void for_blocks(size_t n, size_t block, Body&& body) const {
    interruption_point();
    if (n <= block || threads_ <= 1) {
      for (size_t b = 0; b < n; b += block) body(b, b + block < n ? b + block : n);
    } else {
      run_blocks(n, block, std::function<void(size_t, size_t)>(std::ref(body)));
    }
  }

  /// Sum of body(begin, end) over all blocks, added in block order for any number of threads.
  template <class Body>
  double sum_blocks(size_t n, size_t block, Body&& body) const {
    return sum_of_blocks(n, block, std::function<double(size_t, size_t)>(std::ref(body)));
  }

 private:
  double sum_of_blocks(size_t n, size_t block, const std::function<double(size_t, size_t)>& body) const;
  void run_blocks(size_t n, size_t block, const std::function<void(size_t, size_t)>& body) const;
  int threads_;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Default rows per block: small enough to balance, large enough to be worth a task.
inline constexpr size_t kBlockRows = 2048;

}  // namespace truestep
