#include "server/net/shard.h"

#include <boost/asio/post.hpp>

#include "engine/base/log.h"

namespace truestep::net {

namespace asio = boost::asio;

namespace {
constexpr auto kSweep = std::chrono::milliseconds(250);
}

Shard::Shard(Service& service) : service_(service), work_(io().get_executor()), timer_(io()) {}

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
      io().run();
      return;
    } catch (const std::exception& e) {
      log_error("network thread: {}", e.what());
    }
  }
}

void Shard::adopt(Socket socket) {
  boost::system::error_code ec;
  socket.non_blocking(true, ec);
  socket.set_option(asio::ip::tcp::no_delay(true), ec);
  service_.stats.connections++;
  const auto at = connections_.emplace(connections_.end());
  at->connection = std::make_shared<Connection>(std::move(socket), service_, loop_);
  at->task.emplace(at->connection->run(), context_, [this, at](const std::exception_ptr& failure) {
    if (failure) {
      try {
        std::rethrow_exception(failure);
      } catch (const std::exception& e) {
        log_error("a connection ended with: {}", e.what());
      }
    }
    connections_.erase(at);
    service_.stats.connections--;
  });
  at->task->start();
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
    for (const Served& s : connections_) s.connection->tick(now);
    sweep();
  });
}

void Shard::drain() {
  asio::post(io(), [this] {
    for (const Served& s : connections_) s.connection->drain();
  });
}

void Shard::abort_all() {
  asio::post(io(), [this] {
    for (const Served& s : connections_) s.connection->abort();
    timer_.cancel();
  });
}

void Shard::join() {
  work_.reset();
  if (thread_.joinable()) thread_.join();
}

}  // namespace truestep::net
