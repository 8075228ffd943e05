#include "server/net/event_loop.h"

#include <boost/asio/post.hpp>

#include "server/net/timer.h"

namespace truestep::net {

void EventLoop::post(std::function<void()> f) {
  boost::asio::post(io_, std::move(f));
}

TimerPtr EventLoop::call_at(std::chrono::steady_clock::time_point when,
                            std::function<void(const TimerPtr&)> f) {
  return start_timer(io_.get_executor(), when, std::move(f));
}

}  // namespace truestep::net
