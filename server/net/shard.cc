#include "server/net/shard.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>

#include "engine/base/log.h"

namespace truestep::net {

namespace asio = boost::asio;

namespace {
constexpr auto kSweep = std::chrono::milliseconds(250);
}

Shard::Shard(Service& service) : service_(service), work_(io_.get_executor()), timer_(io_) {}

Shard::~Shard() {
  join();
}

void Shard::start() {
  thread_ = std::thread([this] { run(); });
}

// What a handler throws (out of memory) costs its connection, not the service.
void Shard::run() {
  for (;;) {
    try {
      io_.run();
      return;
    } catch (const std::exception& e) {
      spdlog::error("network thread: {}", e.what());
    }
  }
}

void Shard::adopt(Socket socket) {
  boost::system::error_code ec;
  socket.non_blocking(true, ec);
  socket.set_option(asio::ip::tcp::no_delay(true), ec);
  service_.stats.connections++;
  const auto at =
      connections_.insert(connections_.end(), std::make_shared<Connection>(std::move(socket), service_));
  asio::co_spawn(io_, (*at)->run(), [this, at](std::exception_ptr failure) {
    if (failure) {
      try {
        std::rethrow_exception(failure);
      } catch (const std::exception& e) {
        spdlog::error("a connection ended with: {}", e.what());
      }
    }
    connections_.erase(at);
    service_.stats.connections--;
  });
  if (!sweeping_) sweep();
}

// Runs while there are connections, so an idle server never wakes up.
void Shard::sweep() {
  sweeping_ = !connections_.empty();
  if (!sweeping_) return;
  timer_.expires_after(kSweep);
  timer_.async_wait([this](const boost::system::error_code& ec) {
    if (ec) return;
    const auto now = Clock::now();
    for (const auto& c : connections_) c->tick(now);
    sweep();
  });
}

void Shard::drain() {
  asio::post(io_, [this] {
    for (const auto& c : connections_) c->drain();
  });
}

void Shard::abort_all() {
  asio::post(io_, [this] {
    for (const auto& c : connections_) c->abort();
    timer_.cancel();
  });
}

void Shard::join() {
  work_.reset();
  if (thread_.joinable()) thread_.join();
}

}  // namespace truestep::net
