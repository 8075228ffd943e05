// Where work runs: a network thread's event loop or a pool of threads. server/net makes both from Boost.Asio;
// nobody else needs to know.
#pragma once
#include <chrono>
#include <functional>
#include <memory>

namespace truestep {

/// A call that is due later. Must not outlive the executor that made it.
class Timer {
 public:
  virtual ~Timer() = default;
  /// The call will not be made, unless it is on its way already.
  virtual void cancel() = 0;
};

using TimerPtr = std::shared_ptr<Timer>;

class Executor {
 public:
  virtual ~Executor() = default;
  /// Calls f soon, never before post returns on a thread of the executor itself. Any thread.
  virtual void post(std::function<void()> f) = 0;
  /// Calls f with the timer itself at `when`. The timer lives until then, whoever else holds it.
  virtual TimerPtr call_at(std::chrono::steady_clock::time_point when,
                           std::function<void(const TimerPtr&)> f) = 0;
};

}  // namespace truestep
