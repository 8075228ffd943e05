#include "server/net/timer.h"

#include <boost/asio/steady_timer.hpp>

namespace truestep::net {
namespace {

struct AsioTimer final : Timer {
  explicit AsioTimer(const boost::asio::any_io_executor& executor) : timer(executor) {}
  void cancel() override { timer.cancel(); }
  boost::asio::steady_timer timer;
};

}  // namespace

TimerPtr start_timer(const boost::asio::any_io_executor& executor, std::chrono::steady_clock::time_point when,
                     std::function<void(const TimerPtr&)> f) {
  const auto timer = std::make_shared<AsioTimer>(executor);
  timer->timer.expires_at(when);
  timer->timer.async_wait([timer, f = std::move(f)](const boost::system::error_code& ec) {
    if (!ec) f(timer);
  });
  return timer;
}

}  // namespace truestep::net
