// What the coroutines of one request share: the thread they run on, and whether it has been given up.
#pragma once
#include <exception>
#include <functional>
#include <utility>

#include "server/tasks/executor.h"

namespace truestep {

/// Thrown by co_await in a request that has been given up.
class Cancelled : public std::exception {
 public:
  const char* what() const noexcept override { return "the request has been given up"; }
};

/// Used on the executor's thread only.
class TaskContext {
 public:
  explicit TaskContext(Executor& executor) : executor_(executor) {}
  TaskContext(const TaskContext&) = delete;
  TaskContext& operator=(const TaskContext&) = delete;

  Executor& executor() const { return executor_; }

  /// Ends a wait that can be cut short; the next co_await throws Cancelled.
  void cancel() {
    cancelled_ = true;
    if (wake_) wake_();
  }
  bool cancelled() const { return cancelled_; }
  /// As before any cancel().
  void reset() { cancelled_ = false; }
  void check() const {
    if (cancelled_ && !patient_) throw Cancelled();
  }
  /// Whether co_await goes on although the request has been given up.
  void set_patient(bool patient) { patient_ = patient; }
  /// What cancel() calls, and posts rather than does; null: the present wait cannot be cut short.
  void set_wake(std::function<void()> wake) { wake_ = std::move(wake); }

 private:
  Executor& executor_;
  bool cancelled_ = false, patient_ = false;
  std::function<void()> wake_;
};

}  // namespace truestep
