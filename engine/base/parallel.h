// Parallel loops with a fixed decomposition: the blocks depend only on n and the block size, never on the
// number of threads, so every sum comes out with the same bits. oneTBB underneath.
#pragma once
#include <cstddef>
#include <memory>
#include <span>

#include "engine/base/function_ref.h"

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
  void for_blocks(size_t n, size_t block, FunctionRef<void(size_t, size_t)> body) const;

  /// Sum of body(begin, end) over all blocks, added in block order for any number of threads.
  double sum_blocks(size_t n, size_t block, FunctionRef<double(size_t, size_t)> body) const;

 private:
  void run_blocks(size_t n, size_t block, FunctionRef<void(size_t, size_t)> body) const;
  int threads_;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Default rows per block: small enough to balance, large enough to be worth a task.
inline constexpr size_t kBlockRows = 2048;

}  // namespace truestep
