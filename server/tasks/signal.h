// What coroutines wait for: a signal that other threads raise, for long polls and for the end of work
// elsewhere.
#pragma once
#include <chrono>
#include <coroutine>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "server/tasks/task.h"

namespace truestep {

/// A counter that any thread raises and coroutines wait for. Read version(), check the condition, then wait
/// for a later version: no wake-up is lost in between. Must outlive the executors of those who wait.
class Signal {
 public:
  class Wait;

  uint64_t version() const {
    const std::lock_guard lock(mutex_);
    return version_;
  }
  /// Raises the version and wakes everyone who waits. Any thread.
  void notify();
  /// For co_await: true when the version is, or has become, other than `seen`; false when the time is over or
  /// the request has been given up.
  Wait wait(uint64_t seen, std::chrono::steady_clock::time_point deadline);
  /// How many wait.
  size_t waiting() const {
    const std::lock_guard lock(mutex_);
    return waiters_.size();
  }

 private:
  struct Waiter;
  mutable std::mutex mutex_;
  uint64_t version_ = 0;
  std::vector<std::shared_ptr<Waiter>> waiters_;
};

/// One wait; leaves the signal when it ends, and when its coroutine is destroyed.
class Signal::Wait {
 public:
  Wait(Signal& signal, uint64_t seen, std::chrono::steady_clock::time_point deadline)
      : signal_(signal), seen_(seen), deadline_(deadline) {}
  Wait(const Wait&) = delete;
  Wait& operator=(const Wait&) = delete;
  ~Wait();

  bool await_ready() const { return false; }
  template <class P>
  bool await_suspend(std::coroutine_handle<P> handle) {
    handle.promise().context->check();
    return suspend(handle, *handle.promise().context);
  }
  bool await_resume();

 private:
  bool suspend(std::coroutine_handle<> handle, TaskContext& context);
  void leave();
  Signal& signal_;
  const uint64_t seen_;
  const std::chrono::steady_clock::time_point deadline_;
  TaskContext* context_ = nullptr;
  std::shared_ptr<Waiter> waiter_;
};

inline Signal::Wait Signal::wait(uint64_t seen, std::chrono::steady_clock::time_point deadline) {
  return {*this, seen, deadline};
}

/// Waits until `ended()`, which `done` announces, or the deadline. A coroutine that is given up meanwhile
/// calls `give_up` and still waits, so that work elsewhere may refer to what the coroutine holds.
Task<> wait_for_end(Signal& done, std::function<bool()> ended, std::function<void()> give_up,
                    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::now() +
                                                                     std::chrono::hours(24 * 365));

}  // namespace truestep
