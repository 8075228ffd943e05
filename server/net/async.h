// Waiting in handlers without blocking the network thread: work handed to a thread pool, and a signal that
// other threads raise for long polls.
#pragma once
#include <boost/asio/awaitable.hpp>
#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <type_traits>
#include <vector>

namespace truestep::net {

/// Runs f() on the pool (anything with an executor) and resumes the caller on its own thread with the result;
/// exceptions pass through.
template <class Pool, class F>
boost::asio::awaitable<std::invoke_result_t<F>> offload(Pool& pool, F f) {
  using T = std::invoke_result_t<F>;
  // Named, not a temporary of the co_await expression: gcc 12 destroys the captures of such a closure twice.
  auto work = [f = std::move(f)]() mutable -> boost::asio::awaitable<T> { co_return f(); };
  // Without a cancellation slot: signals are raised on the network thread while the work is on another, and f
  // may refer to what its caller holds.
  co_return co_await boost::asio::co_spawn(
      pool.get_executor(), std::move(work),
      boost::asio::bind_cancellation_slot(boost::asio::cancellation_slot(), boost::asio::use_awaitable));
}

/// A counter that any thread raises and coroutines wait for. Read version(), check the condition, then wait
/// for a later version: no wake-up is lost in between. Must outlive the contexts of those who wait.
class Signal {
 public:
  uint64_t version() const {
    const std::lock_guard lock(mutex_);
    return version_;
  }
  /// Raises the version and wakes everyone who waits. Any thread.
  void notify();
  /// True when the version is, or has become, other than `seen`; false when the time is over or the server
  /// stops.
  boost::asio::awaitable<bool> wait(uint64_t seen, std::chrono::steady_clock::time_point deadline);
  /// How many wait.
  size_t waiting() const {
    const std::lock_guard lock(mutex_);
    return waiters_.size();
  }

 private:
  struct Waiter {
    explicit Waiter(const boost::asio::any_io_executor& executor) : timer(executor) {}
    boost::asio::steady_timer timer;
    bool woken = false;  ///< touched on the waiter's own thread only
  };
  /// Takes a waiter off the list at the end of its wait.
  struct Leave {
    Signal& signal;
    const std::shared_ptr<Waiter>& waiter;
    ~Leave();
  };
  mutable std::mutex mutex_;
  uint64_t version_ = 0;
  std::vector<std::shared_ptr<Waiter>> waiters_;
};

/// Waits until `ended()`, which `done` announces, or the deadline. A coroutine that is cancelled meanwhile
/// calls `give_up` and still waits, so that work elsewhere may refer to what the coroutine holds. Named
/// closures only.
template <class Ended, class GiveUp>
boost::asio::awaitable<void> wait_for_end(
    Signal& done, Ended ended, GiveUp give_up,
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::now() +
                                                     std::chrono::hours(24 * 365)) {
  namespace this_coro = boost::asio::this_coro;
  co_await this_coro::throw_if_cancelled(false);
  while (true) {
    const uint64_t seen = done.version();
    if (ended() || std::chrono::steady_clock::now() >= deadline) break;
    co_await done.wait(seen, deadline);
    const auto state = co_await this_coro::cancellation_state;
    if (state.cancelled() == boost::asio::cancellation_type::none) continue;
    give_up();
    co_await this_coro::reset_cancellation_state();
  }
  co_await this_coro::throw_if_cancelled(true);
}

}  // namespace truestep::net
