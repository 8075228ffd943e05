#include "server/net/termination.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>

namespace truestep::net {

struct Termination::Loop {
  boost::asio::io_context io{1};
  boost::asio::signal_set signals{io, SIGTERM, SIGINT, SIGHUP};
  boost::asio::steady_timer timer{io};

  void call_again(std::chrono::steady_clock::duration pause, const std::function<void()>& f) {
    timer.expires_after(pause);
    timer.async_wait([this, pause, &f](const boost::system::error_code& ec) {
      if (ec) return;
      f();
      call_again(pause, f);
    });
  }
};

Termination::Termination() : loop_(std::make_unique<Loop>()) {}
Termination::~Termination() = default;

void Termination::wait(std::chrono::steady_clock::duration pause, const std::function<void()>& f) {
  loop_->call_again(pause, f);
  loop_->signals.async_wait([this](const boost::system::error_code&, int) {
    loop_->timer.cancel();
    loop_->io.stop();
  });
  loop_->io.run();
}

}  // namespace truestep::net
