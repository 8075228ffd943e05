// The threads that advance sessions: a timer per playing session (none for an idle one), jobs of many steps
// in slices, and a thread for pictures. Nothing here runs on a network thread.
#pragma once
#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <optional>

#include "server/sessions/entry.h"

namespace truestep {

class Runner {
 public:
  explicit Runner(int workers);
  ~Runner();

  boost::asio::thread_pool& pool() { return pool_; }
  boost::asio::thread_pool& picture_thread() { return picture_thread_; }

  /// Starts the timer of a playing session; call after Session::play with the entry's lock held.
  void keep_playing(const EntryPtr& entry);

  /// Steps until `target` (a step number) in slices of some milliseconds, so that other sessions and readers
  /// of this one get their turn. Returns the step reached: earlier after an instability, removal or stop.
  boost::asio::awaitable<uint64_t> step_to(EntryPtr entry, uint64_t target);

  /// Ends timers and jobs and joins the threads.
  void stop();

  uint64_t steps_done() const { return steps_.load(std::memory_order_relaxed); }

 private:
  void tick(const EntryPtr& entry, const std::shared_ptr<boost::asio::steady_timer>& timer,
            Clock::time_point last);
  boost::asio::awaitable<uint64_t> run_slices(EntryPtr entry, uint64_t target);

  boost::asio::thread_pool pool_, picture_thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<uint64_t> steps_{0};
};

}  // namespace truestep
