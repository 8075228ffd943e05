// The event loop of a network thread as an Executor: what Boost.Asio calls an io_context with one thread.
#pragma once
#include <boost/asio/io_context.hpp>

#include "server/tasks/executor.h"

namespace truestep::net {

class EventLoop final : public Executor {
 public:
  void post(std::function<void()> f) override;
  TimerPtr call_at(std::chrono::steady_clock::time_point when,
                   std::function<void(const TimerPtr&)> f) override;
  boost::asio::io_context& io() { return io_; }

 private:
  boost::asio::io_context io_{1};
};

}  // namespace truestep::net
