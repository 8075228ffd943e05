#include "server/net/server.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <condition_variable>
#include <vector>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "server/net/connection.h"
#include "server/net/shard.h"

namespace truestep::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using Acceptor = asio::basic_socket_acceptor<tcp, asio::io_context::executor_type>;

namespace {

// Descriptors left for files, pipes and libraries.
constexpr size_t kReservedDescriptors = 96;
constexpr auto kAcceptPause = std::chrono::milliseconds(20);

constexpr std::string_view kOverloaded =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nRetry-After: "
    "1\r\nConnection: close\r\n"
    "Content-Length: 110\r\n\r\n"
    "{\"type\":\"urn:truestep:problem:overloaded\",\"title\":\"The service is at its "
    "limit\",\"status\":503,\"code\":\"overloaded\"}";

size_t descriptor_limit(size_t wanted) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
  if (limit.rlim_cur < wanted && limit.rlim_cur < limit.rlim_max) {
    limit.rlim_cur = std::min<rlim_t>(wanted, limit.rlim_max);
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
  }
  return limit.rlim_cur == RLIM_INFINITY ? wanted : static_cast<size_t>(limit.rlim_cur);
}

int spare_descriptor() {
  return ::open("/dev/null", O_RDONLY | O_CLOEXEC);
}

}  // namespace

struct Server::Impl {
  Impl(Options options, Router router) : service(std::move(options), std::move(router)) {}

  void bind();
  void accept_next();
  void accepted(const boost::system::error_code& ec, Socket socket);
  void turn_away(Socket socket);
  void pause();

  Service service;
  std::vector<std::unique_ptr<Shard>> shards;
  std::unique_ptr<Acceptor> acceptor;
  std::unique_ptr<asio::steady_timer> pause_timer;
  size_t next_shard = 0;
  int spare = -1;  ///< closed to accept and refuse one connection when descriptors run out
  uint16_t port = 0;
  bool started = false, stopped = false;
};

void Server::Impl::bind() {
  const Options& o = service.options;
  boost::system::error_code ec;
  const auto address = asio::ip::make_address(o.host == "localhost" ? "127.0.0.1" : o.host, ec);
  if (ec) throw Error("bad_request", "'" + o.host + "' is not an address to listen on");
  const tcp::endpoint endpoint(address, o.port);
  acceptor = std::make_unique<Acceptor>(shards[0]->io().get_executor());
  acceptor->open(endpoint.protocol(), ec);
  if (!ec) acceptor->set_option(asio::socket_base::reuse_address(true), ec);
  if (!ec) acceptor->bind(endpoint, ec);
  if (!ec) acceptor->listen(4096, ec);
  if (ec)
    throw Error("bind_failed",
                "cannot listen on " + o.host + ":" + std::to_string(o.port) + ": " + ec.message());
  port = acceptor->local_endpoint().port();
}

void Server::Impl::accept_next() {
  if (!acceptor->is_open()) return;
  Shard& shard = *shards[next_shard++ % shards.size()];
  acceptor->async_accept(
      shard.io().get_executor(), [this, &shard](const boost::system::error_code& ec, Socket socket) {
        if (!ec && static_cast<size_t>(service.stats.connections) < service.options.max_connections) {
          service.stats.accepted++;
          if (&shard == shards[0].get()) {
            shard.adopt(std::move(socket));
          } else {
            asio::post(shard.io(), [&shard, s = std::move(socket)]() mutable { shard.adopt(std::move(s)); });
          }
          accept_next();
        } else {
          accepted(ec, std::move(socket));
        }
      });
}

void Server::Impl::accepted(const boost::system::error_code& ec, Socket socket) {
  if (ec == asio::error::operation_aborted || !acceptor->is_open()) return;
  if (!ec) {
    turn_away(std::move(socket));
    accept_next();
    return;
  }
  if (ec == asio::error::no_descriptors || ec.value() == ENFILE) {
    // The waiting client would keep the listener readable for ever: use the spare descriptor to tell it.
    ::close(spare);
    boost::system::error_code accept_error;
    Socket extra(shards[0]->io().get_executor());
    acceptor->non_blocking(true, accept_error);
    acceptor->accept(extra, accept_error);
    if (!accept_error) turn_away(std::move(extra));
    spare = spare_descriptor();
  }
  pause();
}

void Server::Impl::turn_away(Socket socket) {
  service.stats.refused++;
  boost::system::error_code ec;
  socket.native_non_blocking(true, ec);
  ::send(socket.native_handle(), kOverloaded.data(), kOverloaded.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  socket.shutdown(Socket::shutdown_send, ec);
  // What the client has already sent would turn the close into a reset that destroys the answer.
  char scratch[4096];
  while (::recv(socket.native_handle(), scratch, sizeof scratch, MSG_DONTWAIT) > 0) {
  }
  socket.close(ec);
}

void Server::Impl::pause() {
  pause_timer->expires_after(kAcceptPause);
  pause_timer->async_wait([this](const boost::system::error_code& ec) {
    if (!ec) accept_next();
  });
}

Server::Server(Options options, Router router)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(router))) {}

Server::~Server() {
  stop(std::chrono::milliseconds(0));
  if (impl_->spare >= 0) ::close(impl_->spare);
}

void Server::start() {
  Impl& s = *impl_;
  Options& o = s.service.options;
  const size_t descriptors = descriptor_limit(o.max_connections + kReservedDescriptors);
  const size_t usable =
      descriptors > 2 * kReservedDescriptors ? descriptors - kReservedDescriptors : descriptors / 2;
  if (o.max_connections > usable) {
    log_info("at most {} connections: this process may open {} descriptors", usable, descriptors);
    o.max_connections = usable;
  }
  for (int i = 0; i < std::max(1, o.threads); ++i) s.shards.push_back(std::make_unique<Shard>(s.service));
  s.bind();
  s.spare = spare_descriptor();
  s.pause_timer = std::make_unique<asio::steady_timer>(s.shards[0]->io());
  s.accept_next();
  for (auto& shard : s.shards) shard->start();
  s.started = true;
}

void Server::drain() {
  Impl& s = *impl_;
  if (!s.started || s.service.draining.exchange(true)) return;
  asio::post(s.shards[0]->io(), [&s] {
    boost::system::error_code ec;
    s.acceptor->close(ec);
    s.pause_timer->cancel();
  });
  for (auto& shard : s.shards) shard->drain();
}

void Server::stop(std::chrono::milliseconds grace) {
  Impl& s = *impl_;
  if (!s.started || s.stopped) return;
  s.stopped = true;
  drain();
  const auto wait_until = [&](Clock::time_point end) {
    while (s.service.stats.connections > 0 && Clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  wait_until(Clock::now() + grace);
  for (auto& shard : s.shards) shard->abort_all();
  // Aborted connections end by themselves; only a handler still waiting for its own work can outlast this.
  wait_until(Clock::now() + std::chrono::milliseconds(500));
  for (auto& shard : s.shards) {
    if (s.service.stats.connections > 0) shard->stop_loop();
    shard->join();
  }
}

void Server::reload_keys() {
  impl_->service.guard.keys().reload();
}

bool Server::draining() const {
  return impl_->service.draining;
}
uint16_t Server::port() const {
  return impl_->port;
}

std::string Server::url() const {
  const std::string& host = impl_->service.options.host;
  return "http://" + (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" +
         std::to_string(impl_->port);
}

const ServerStats& Server::stats() const {
  return impl_->service.stats;
}
const Router& Server::router() const {
  return impl_->service.router;
}

}  // namespace truestep::net
