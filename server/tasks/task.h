// A coroutine that is awaited by another one, or run by a RootTask. It starts when it is awaited, hands its
// thread over without growing the stack, passes exceptions on, and is destroyed with whoever awaits it.
// co_await stands in statements of its own, and closures with captures that own something are named before
// they are handed over: GCC 12 destroys the awaitable of a co_await that && or || has skipped, and the
// captures of a temporary closure in a co_await expression twice.
#pragma once
#include <coroutine>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "server/tasks/task_context.h"

namespace truestep {

class RootTask;

namespace task_detail {

struct Promise {
  TaskContext* context = nullptr;
  std::coroutine_handle<> continuation;
  RootTask* root = nullptr;  ///< when nobody awaits it
  std::exception_ptr error;
  bool starting = false, ended = false;

  struct Final {
    bool await_ready() noexcept { return false; }
    template <class P>
    std::coroutine_handle<> await_suspend(std::coroutine_handle<P> handle) noexcept {
      return handle.promise().next();
    }
    void await_resume() noexcept {}
  };

  std::suspend_always initial_suspend() noexcept { return {}; }
  Final final_suspend() noexcept { return {}; }
  void unhandled_exception() { error = std::current_exception(); }
  std::coroutine_handle<> next() noexcept;
};

/// Asks for the context: `TaskContext& c = co_await Here();`
class Here {
 public:
  bool await_ready() const noexcept { return false; }
  template <class P>
  bool await_suspend(std::coroutine_handle<P> handle) noexcept {
    context_ = handle.promise().context;
    return false;
  }
  TaskContext& await_resume() const noexcept { return *context_; }

 private:
  TaskContext* context_ = nullptr;
};

template <class T>
struct ResultPromise : Promise {
  std::optional<T> value;
  template <class U>
  void return_value(U&& v) {
    value.emplace(std::forward<U>(v));
  }
  T take() {
    if (error) std::rethrow_exception(error);
    return std::move(*value);
  }
};

template <>
struct ResultPromise<void> : Promise {
  void return_void() {}
  void take() {
    if (error) std::rethrow_exception(error);
  }
};

}  // namespace task_detail

template <class T = void>
class [[nodiscard]] Task {
 public:
  struct promise_type : task_detail::ResultPromise<T> {
    Task get_return_object() { return Task(std::coroutine_handle<promise_type>::from_promise(*this)); }
  };
  Task(Task&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Task& operator=(Task&&) = delete;
  ~Task() {
    if (handle_) handle_.destroy();
  }

  /// Runs in this context, not in that of the coroutine that awaits it.
  void run_in(TaskContext& context) { handle_.promise().context = &context; }

  bool await_ready() const noexcept { return false; }
  /// Throws Cancelled instead of starting once the request has been given up.
  template <class P>
  bool await_suspend(std::coroutine_handle<P> parent) {
    parent.promise().context->check();
    auto& promise = handle_.promise();
    promise.continuation = parent;
    if (!promise.context) promise.context = parent.promise().context;
    // One that ends at once returns here instead of resuming its parent: where the compiler makes no tail
    // calls (sanitizers), a loop over such tasks would need ever more stack.
    promise.starting = true;
    handle_.resume();
    promise.starting = false;
    return !promise.ended;
  }
  T await_resume() { return handle_.promise().take(); }

 private:
  friend class RootTask;
  explicit Task(std::coroutine_handle<promise_type> handle) : handle_(handle) {}
  std::coroutine_handle<promise_type> handle_;
};

/// Runs a task that nobody awaits, on the thread that calls start(). Destroying it destroys the task where it
/// waits.
class RootTask {
 public:
  /// `ended` is called last, with what the task has thrown; it may destroy this.
  RootTask(Task<void> task, TaskContext& context, std::function<void(std::exception_ptr)> ended);
  RootTask(const RootTask&) = delete;
  RootTask& operator=(const RootTask&) = delete;
  void start() { task_.handle_.resume(); }

 private:
  friend struct task_detail::Promise;
  Task<void> task_;
  std::function<void(std::exception_ptr)> ended_;
};

}  // namespace truestep
