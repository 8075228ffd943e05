#include "engine/base/thread_team.h"

#include <tbb/task_arena.h>

#include <atomic>
#include <thread>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace truestep {

namespace {

/// How often a helper checks the ticket before it yields its core.
constexpr int kPatience = 2000;
/// A ticket packs: number of the loop, its blocks, blocks taken.
constexpr int kBits = 24;
constexpr uint64_t kMask = (uint64_t{1} << kBits) - 1;

void pause() {
#if defined(__x86_64__)
  _mm_pause();
#else
  std::this_thread::yield();
#endif
}

}  // namespace

struct ThreadTeam::Work {
  alignas(64) std::atomic<uint64_t> ticket = 0;
  alignas(64) std::atomic<size_t> done = 0;
  alignas(64) std::atomic<bool> over = false;
  std::atomic<int> called = 0;
  tbb::task_arena helpers;
  // Written before the ticket of a loop, read by the threads that took a block of it.
  size_t n = 0, block = 0;
  Call call = nullptr;
  void* body = nullptr;

  /// Does one block; false when none is left.
  bool help() {
    const auto left = [](uint64_t t) { return (t & kMask) < (t >> kBits & kMask); };
    if (!left(ticket.load(std::memory_order_relaxed))) return false;
    const uint64_t t = ticket.fetch_add(1, std::memory_order_acquire);
    if (!left(t)) return false;
    const size_t begin = (t & kMask) * block;
    call(body, begin, std::min(n, begin + block));
    done.fetch_add(1, std::memory_order_release);
    return true;
  }
  void stand_by() {
    for (int idle = 0; !over.load(std::memory_order_relaxed);) {
      if (help()) {
        idle = 0;
      } else if (++idle < kPatience) {
        pause();
      } else {
        std::this_thread::yield();
      }
    }
    --called;
  }
};

ThreadTeam::ThreadTeam() = default;
ThreadTeam::~ThreadTeam() = default;

ThreadTeam::Gathering ThreadTeam::gather(const ThreadArena& arena) {
  gathered_ = arena.threads() > 1;
  if (gathered_ && !work_) work_ = std::make_shared<Work>();
  if (gathered_) {
    work_->over = false;
    // Helpers that were called last time and arrive only now may join.
    while (work_->called < arena.threads() - 1) {
      ++work_->called;
#ifdef TRUESTEP_PLAIN_THREADS  // see parallel.cc
      std::thread([work = work_] { work->stand_by(); }).detach();
#else
      work_->helpers.enqueue([work = work_] { work->stand_by(); });
#endif
    }
  }
  return Gathering(*this);
}

void ThreadTeam::dismiss() {
  if (gathered_) work_->over = true;
  gathered_ = false;
}

void ThreadTeam::run(size_t n, size_t block, Call call, void* body) const {
  Work& w = *work_;
  const size_t blocks = (n + block - 1) / block;
  w.n = n, w.block = block, w.call = call, w.body = body;
  w.done.store(0, std::memory_order_relaxed);
  const uint64_t loop = (w.ticket.load(std::memory_order_relaxed) >> (2 * kBits)) + 1;
  w.ticket.store(loop << (2 * kBits) | static_cast<uint64_t>(blocks) << kBits, std::memory_order_release);
  while (w.help()) {
  }
  while (w.done.load(std::memory_order_acquire) < blocks) pause();
}

}  // namespace truestep
