#include "server/tasks/signal.h"

namespace truestep {

// Everything but the executor is touched on the waiting coroutine's own thread only.
struct Signal::Waiter {
  Executor& executor;
  std::coroutine_handle<> handle;  ///< null: it waits no more
  TimerPtr timer;
  bool woken = false;

  void resume() {
    if (handle) std::exchange(handle, nullptr).resume();
  }
};

void Signal::notify() {
  std::vector<std::shared_ptr<Waiter>> woken;
  {
    const std::lock_guard lock(mutex_);
    ++version_;
    woken.swap(waiters_);
  }
  for (auto& w : woken) {
    w->executor.post([w] {
      w->woken = true;
      w->resume();
    });
  }
}

bool Signal::Wait::suspend(std::coroutine_handle<> handle, TaskContext& context) {
  waiter_ = std::make_shared<Waiter>(Waiter{context.executor(), handle, nullptr});
  {
    const std::lock_guard lock(signal_.mutex_);
    if (signal_.version_ != seen_) return false;
    signal_.waiters_.push_back(waiter_);
  }
  // notify() posts to this thread, so the coroutine is not resumed before this has returned.
  waiter_->timer = context.executor().call_at(deadline_, [w = waiter_](const TimerPtr&) { w->resume(); });
  context_ = &context;
  context.set_wake([w = waiter_] { w->executor.post([w] { w->resume(); }); });
  return true;
}

bool Signal::Wait::await_resume() {
  leave();
  return waiter_->woken || signal_.version() != seen_;
}

Signal::Wait::~Wait() {
  leave();
}

// Also when the coroutine is destroyed with its executor: no timer may outlive that.
void Signal::Wait::leave() {
  if (!context_) return;
  std::exchange(context_, nullptr)->set_wake(nullptr);
  waiter_->handle = nullptr;
  std::exchange(waiter_->timer, nullptr)->cancel();
  const std::lock_guard lock(signal_.mutex_);
  std::erase(signal_.waiters_, waiter_);
}

Task<> wait_for_end(Signal& done, std::function<bool()> ended, std::function<void()> give_up,
                    std::chrono::steady_clock::time_point deadline) {
  TaskContext& context = co_await task_detail::Here();
  context.set_patient(true);
  while (true) {
    const uint64_t seen = done.version();
    if (ended() || std::chrono::steady_clock::now() >= deadline) break;
    co_await done.wait(seen, deadline);
    if (!context.cancelled()) continue;
    give_up();
    context.reset();
  }
  context.set_patient(false);
}

}  // namespace truestep
