// Work of a coroutine on another thread, so that the network thread is not blocked.
#pragma once
#include <coroutine>
#include <exception>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "server/tasks/task.h"

namespace truestep {

/// For co_await: runs a call on an executor and resumes the coroutine on its own thread; exceptions pass
/// through. Cannot be cut short: the work may refer to what the coroutine holds.
class Elsewhere {
 public:
  Elsewhere(Executor& executor, std::function<void()> work) : executor_(executor), work_(std::move(work)) {}
  Elsewhere(const Elsewhere&) = delete;
  Elsewhere& operator=(const Elsewhere&) = delete;

  bool await_ready() const { return false; }
  template <class P>
  void await_suspend(std::coroutine_handle<P> handle) {
    handle.promise().context->check();
    start(handle, handle.promise().context->executor());
  }
  void await_resume() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void start(std::coroutine_handle<> handle, Executor& home);
  Executor& executor_;
  std::function<void()> work_;
  std::exception_ptr error_;
};

/// Runs f() on an executor and returns its result to the coroutine's own thread.
template <class T>
Task<T> result_from(Executor& executor, std::function<T()> f) {
  std::optional<T> result;
  Elsewhere work(executor, [&] { result.emplace(f()); });
  co_await work;
  co_return std::move(*result);
}
template <class F>
Task<std::invoke_result_t<F>> offload(Executor& executor, F f) {
  return result_from<std::invoke_result_t<F>>(executor, std::move(f));
}

}  // namespace truestep
