// Waiting in handlers without blocking the network thread: work handed to a thread pool, and a signal that
// other threads raise for long polls.
#pragma once
#include <boost/asio/awaitable.hpp>
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
  co_return co_await boost::asio::co_spawn(pool.get_executor(), std::move(work), boost::asio::use_awaitable);
}

/// A counter that any thread raises and coroutines wait for. Read version(), check the condition, then wait
/// for a later version: no wake-up is lost in between.
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

 private:
  struct Waiter {
    explicit Waiter(boost::asio::any_io_executor executor) : timer(std::move(executor)) {}
    boost::asio::steady_timer timer;
    bool woken = false;  ///< touched on the waiter's own thread only
  };
  mutable std::mutex mutex_;
  uint64_t version_ = 0;
  std::vector<std::shared_ptr<Waiter>> waiters_;
};

}  // namespace truestep::net
