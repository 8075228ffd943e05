#include "engine/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "engine/base/interrupt.h"

namespace truestep {

struct ThreadArena::Impl {
  explicit Impl(int threads) : arena(threads) {}
  tbb::task_arena arena;
};

ThreadArena::ThreadArena(int threads) : threads_(std::max(threads, 1)) {
  if (threads_ > 1) impl_ = std::make_unique<Impl>(threads_);
}
ThreadArena::~ThreadArena() = default;

void ThreadArena::for_blocks(size_t n, size_t block, FunctionRef<void(size_t, size_t)> body) const {
  interruption_point();
  if (n > block && threads_ > 1) return run_blocks(n, block, body);
  for (size_t b = 0; b < n; b += block) body(b, std::min(n, b + block));
}

void ThreadArena::run_blocks(size_t n, size_t block, FunctionRef<void(size_t, size_t)> body) const {
  const size_t blocks = (n + block - 1) / block;
  const auto run = [&](size_t b) { body(b * block, std::min(n, (b + 1) * block)); };
#ifdef TRUESTEP_PLAIN_THREADS
  // oneTBB is not built with the thread sanitizer, which reports its hand-over of tasks as races.
  std::atomic<size_t> next = 0;
  std::vector<std::jthread> team;
  for (int k = 0; k < threads_; ++k) {
    team.emplace_back([&] {
      for (size_t b = next++; b < blocks; b = next++) run(b);
    });
  }
#else
  impl_->arena.execute([&] { tbb::parallel_for(size_t{0}, blocks, run); });
#endif
}

double ThreadArena::sum_blocks(size_t n, size_t block, FunctionRef<double(size_t, size_t)> body) const {
  double total = 0;
  if (n <= block || threads_ <= 1) {
    for (size_t b = 0; b < n; b += block) total += body(b, std::min(n, b + block));
    return total;
  }
  std::vector<double> partial((n + block - 1) / block);
  run_blocks(n, block, [&](size_t begin, size_t end) { partial[begin / block] = body(begin, end); });
  for (const double p : partial) total += p;
  return total;
}

}  // namespace truestep
