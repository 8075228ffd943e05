#include "server/net/connection.h"

#include <sys/socket.h>

#include <cerrno>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/base/log.h"
#include "server/net/http/problem.h"
#include "server/net/websocket/handshake.h"

namespace truestep::net {

namespace {

constexpr size_t kReadBody = 65536;
constexpr int kPatientLooks = 8;
constexpr auto kLinger = std::chrono::milliseconds(1000);
// A body that arrives faster than this may take longer than the body time-out.
constexpr size_t kBodyBytesPerSecond = 65536;

std::string endpoint_text(const Socket& socket) {
  boost::system::error_code ec;
  const auto e = socket.remote_endpoint(ec);
  if (ec) return {};
  const std::string address = e.address().to_string();
  return (e.address().is_v6() ? "[" + address + "]" : address) + ":" + std::to_string(e.port());
}

std::string_view code_of(int status) {
  switch (status) {
    case 408:
      return "request_timeout";
    case 413:
      return "too_large";
    case 414:
    case 431:
      return "head_too_large";
    case 417:
      return "expectation_failed";
    case 501:
    case 505:
      return "not_implemented";
    default:
      return "bad_request";
  }
}

}  // namespace

Connection::Connection(Socket socket, Service& service, Executor& loop)
    : socket_(std::move(socket)), service_(service), remote_(endpoint_text(socket_)), handler_context_(loop) {
  enter(Phase::idle);
}

void Connection::enter(Phase phase) {
  const Options& o = service_.options;
  phase_ = phase;
  switch (phase) {
    case Phase::idle:
      deadline_ = Clock::now() + o.idle_timeout;
      break;
    case Phase::head:
      deadline_ = Clock::now() + o.head_timeout;
      break;
    case Phase::body:
      deadline_ = Clock::now() + o.body_timeout;
      break;
    case Phase::write:
      deadline_ = Clock::now() + o.write_timeout;
      break;
    case Phase::linger:
      deadline_ = Clock::now() + kLinger;
      break;
    case Phase::handler:
      deadline_ = Clock::time_point::max();
      break;
  }
}

void Connection::tick(Clock::time_point now) {
  if (websocket_) {
    check_key_again();
    return websocket_->tick(now);
  }
  if (phase_ == Phase::handler && left()) {
    gone_ = true;
    handler_context_.cancel();
  }
  if (now <= deadline_) return;
  service_.stats.timeouts++;
  if ((phase_ == Phase::head || phase_ == Phase::body) && !timed_out_) {
    // Ends the read; the coroutine then answers 408.
    timed_out_ = true;
    boost::system::error_code ec;
    socket_.cancel(ec);
  } else {
    abort();
  }
}

// Whether the peer has gone and cannot read an answer. A peer that has only closed its sending side may still
// be reading: it is given a few checks' time.
bool Connection::left() {
  char byte;
  const ssize_t n = ::recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  if (n > 0 || (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))) return false;
  return n < 0 || ++ended_looks_ > kPatientLooks;
}

// Withdrawing a key ends the streams opened with it.
void Connection::check_key_again() {
  KeyFile& keys = service_.guard.keys();
  if (!keys.asks() || request_.key_digest.empty()) return;
  const auto ring = keys.keys();
  if (keys.version() == std::exchange(keys_version_, keys.version())) return;
  if (!ring->find(request_.key_digest)) websocket_->close(1008, "the key is no longer valid");
}

void Connection::drain() {
  if (websocket_) return websocket_->close(1001, "the service is shutting down");
  if (phase_ == Phase::idle) return abort();
  if (phase_ == Phase::handler) handler_context_.cancel();
}

void Connection::abort() {
  if (websocket_) return websocket_->abort();
  boost::system::error_code ec;
  socket_.close(ec);
}

Task<> Connection::run() {
  const auto self = shared_from_this();
  while (!closing_) {
    const bool complete = co_await read_head();
    if (!complete) break;
    request_.received = std::chrono::system_clock::now();
    request_.remote = remote_;
    service_.stats.requests.fetch_add(1, std::memory_order_relaxed);

    if (auto denied = service_.guard.check_source(request_)) {
      deny(std::move(*denied));
      break;
    }
    Router::Match match = service_.router.find(request_);
    if (!match.route || match.route->access == Access::key) {
      if (auto denied = service_.guard.check_key(request_)) {
        deny(std::move(*denied));
        break;
      }
    }
    if (parser_->has_body()) {
      const size_t limit =
          match.route && match.route->max_body ? match.route->max_body : service_.options.max_body;
      if (!co_await read_body(limit)) break;
    }
    Response response;
    if (!match.route) {
      response = no_route(match);
    } else if (!may_change(request_)) {
      response = problem(request_, "precondition_failed", "If-Match names another state of this resource");
    } else if (match.route->handler) {
      response = answer(*match.route);
    } else if (match.route->async_handler) {
      if (!out_.empty()) {
        if (!co_await write_out()) break;
      }
      response = co_await wait_for(*match.route);
    } else {
      response = co_await open_websocket(*match.route);
      if (upgrade_) break;
    }
    std::string_view large_body;
    if (!prepare(response, large_body)) {
      if (!co_await finish_response(response, large_body)) break;
    }
  }
  if (!out_.empty() && socket_.is_open()) co_await write_out();
  if (upgrade_ && socket_.is_open()) {
    websocket_ = make_websocket(std::move(socket_), request_, std::move(upgrade_), service_.options.websocket,
                                std::move(subprotocol_));
    parser_.reset();
    buffer_ = {};
    std::string().swap(out_);
    service_.stats.websockets++;
    co_await websocket_->run();
    service_.stats.websockets--;
  } else if (unread_ && socket_.is_open()) {
    co_await linger();
  }
  abort();
}

RequestParser::Progress Connection::parse() {
  const auto data = buffer_.data();
  buffer_.consume(parser_->feed({static_cast<const char*>(data.data()), data.size()}));
  return parser_->progress();
}

Task<bool> Connection::read_head() {
  enter(Phase::idle);
  parser_.emplace(request_, service_.options.max_head);
  if (buffer_.size() == 0 && buffer_.capacity() > 2 * kRead) buffer_.shrink_to_fit();
  while (parse() == RequestParser::Progress::need_more) {
    if (!out_.empty()) {
      if (!co_await write_out()) co_return false;
      enter(Phase::idle);
    }
    if (phase_ == Phase::idle && (parser_->got_some() || buffer_.size() > 0)) enter(Phase::head);
    const bool more = co_await read_more(kRead);
    if (more) continue;
    if (timed_out_ && phase_ == Phase::head) {
      request_.clear();
      refuse(408, "the request's head took too long to arrive");
    }
    co_return false;
  }
  if (parser_->status() == 0) co_return true;
  request_.clear();
  refuse(parser_->status(), parser_->reason());
  co_return false;
}

Task<bool> Connection::read_body(size_t limit) {
  enter(Phase::body);
  parser_->set_body_limit(limit);
  if (parser_->expects_continue() && buffer_.size() == 0 && parser_->status() == 0) {
    out_ += "HTTP/1.1 100 Continue\r\n\r\n";
    if (!co_await write_out()) co_return false;
    enter(Phase::body);
  }
  for (;;) {
    const size_t before = request_.body.size();
    const auto progress = parser_->status() == 0 ? parse() : RequestParser::Progress::refused;
    deadline_ += std::chrono::microseconds((request_.body.size() - before) * 1000000 / kBodyBytesPerSecond);
    if (progress == RequestParser::Progress::refused) {
      refuse(parser_->status(), parser_->reason());
      co_return false;
    }
    if (progress == RequestParser::Progress::complete) {
      enter(Phase::handler);
      co_return true;
    }
    const size_t size =
        std::clamp<uint64_t>(parser_->content_length_remaining().value_or(kReadBody), kRead, kReadBody);
    const bool more = co_await read_more(size);
    if (more) continue;
    if (timed_out_) refuse(408, "the request's body took too long to arrive");
    co_return false;
  }
}

Task<bool> Connection::read_more(size_t size) {
  const auto [error, n] =
      co_await Io([&](const Resume& handler) { socket_.async_read_some(buffer_.prepare(size), handler); });
  buffer_.commit(n);
  co_return !error;
}

Response Connection::answer(const Route& route) {
  try {
    if (route.check) route.check(request_);
    return route.handler(request_);
  } catch (const Error& e) {
    return problem(request_, e);
  } catch (const std::exception& e) {
    return problem(request_, e);
  }
}

Task<Response> Connection::wait_for(const Route& route) {
  enter(Phase::handler);
  ended_looks_ = 0;
  try {
    if (route.check) route.check(request_);
    Task<Response> handler = route.async_handler(request_);
    handler_context_.reset();
    handler.run_in(handler_context_);
    co_return co_await handler;
  } catch (const Interrupted& e) {
    if (service_.draining) co_return problem(request_, e);
    co_return problem(request_, "interrupted",
                      "another request ended this work: what it was for was deleted");
  } catch (const Error& e) {
    co_return problem(request_, e);
  } catch (const std::exception& e) {
    if (service_.draining) co_return problem(request_, "draining", "the service is shutting down");
    // Nobody would read it.
    if (gone_) co_return problem(request_, "request_timeout", "the client disconnected");
    co_return problem(request_, e);
  }
}

Response Connection::no_route(const Router::Match& match) {
  if (request_.target == "*") return Response(204);
  if (!match.path_known) return problem(request_, "not_found", "there is no such path");
  if (request_.method == Method::options) {
    Response r(204);
    r.header("Allow", match.allow);
    return r;
  }
  Response r = problem(request_, "method_not_allowed", "allowed here: " + match.allow);
  r.header("Allow", match.allow);
  return r;
}

// Queues a response after which the connection ends even if the peer is still sending.
void Connection::deny(Response response) {
  closing_ = true;
  unread_ = true;
  std::string_view large;
  prepare(response, large);
}

void Connection::refuse(int status, std::string_view reason) {
  Response r = problem(request_, code_of(status), reason);
  r.status = status;
  deny(std::move(r));
}

// On success upgrade_ is set.
Task<Response> Connection::open_websocket(const Route& route) {
  if (!request_.body.empty() || buffer_.size() > 0)
    co_return problem(request_, "bad_request", "nothing may be sent after a handshake before its answer");
  if (auto refused = check_handshake(request_, route, subprotocol_)) co_return std::move(*refused);
  try {
    if (route.check) route.check(request_);
    if (route.before_open) {
      enter(Phase::handler);
      ended_looks_ = 0;
      Task<> before = route.before_open(request_);
      handler_context_.reset();
      before.run_in(handler_context_);
      co_await before;
    }
    if (service_.draining) co_return problem(request_, "draining", "the service is shutting down");
    upgrade_ = route.open_websocket(request_);
  } catch (const Error& e) {
    co_return problem(request_, e);
  } catch (const std::exception& e) {
    if (service_.draining) co_return problem(request_, "draining", "the service is shutting down");
    co_return problem(request_, e);
  }
  co_return Response{};
}

}  // namespace truestep::net
