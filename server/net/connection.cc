#include "server/net/connection.h"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "server/net/chunk_decoder.h"
#include "server/net/problem.h"

namespace truestep::net {

namespace asio = boost::asio;

namespace {

constexpr size_t kFirstBuffer = 4096;
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

Connection::Connection(Socket socket, Service& service)
    : socket_(std::move(socket)),
      service_(service),
      parser_(service.options.max_head),
      buffer_(kFirstBuffer, '\0'),
      remote_(endpoint_text(socket_)) {
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
  if (websocket_) return websocket_->tick(now);
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

void Connection::drain() {
  if (websocket_) return websocket_->close(1001, "the service is shutting down");
  if (phase_ == Phase::idle) return abort();
  if (phase_ == Phase::handler) cancel_handler_.emit(asio::cancellation_type::terminal);
}

void Connection::abort() {
  if (websocket_) return websocket_->abort();
  boost::system::error_code ec;
  socket_.close(ec);
}

// co_await stands in statements of its own: GCC 12 destroys the awaitable of a co_await that && or || has
// skipped.
asio::awaitable<void> Connection::run() {
  const auto self = shared_from_this();
  for (;;) {
    const HeadParser::Result result = parser_.parse({buffer_.data() + begin_, end_ - begin_}, request_);
    if (result == HeadParser::Result::need_more) {
      if (!out_.empty() && !flush_now({})) {
        if (!co_await write_out({})) break;
        enter(Phase::idle);
      }
      if (end_ > begin_ && phase_ == Phase::idle) enter(Phase::head);
      if (!co_await read_more()) break;
      continue;
    }
    if (result == HeadParser::Result::error) {
      request_.clear();
      refuse(parser_.status(), parser_.reason());
      break;
    }
    begin_ += parser_.consumed();
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
    if (parser_.framing() != Framing::none) {
      const size_t limit =
          match.route && match.route->max_body ? match.route->max_body : service_.options.max_body;
      if (!co_await read_body(limit)) break;
    }
    Response response;
    if (!match.route) {
      response = no_route(match);
    } else if (match.route->handler) {
      response = answer(*match.route);
    } else if (match.route->async_handler) {
      if (!out_.empty() && !flush_now({})) {
        if (!co_await write_out({})) break;
      }
      response = co_await wait_for(*match.route);
    } else {
      response = open_websocket(*match.route);
      if (upgrade_) break;
    }
    std::string_view large_body;
    if (!prepare(response, large_body)) {
      if (!co_await finish_response(response, large_body)) break;
    }
    if (closing_) break;
    parser_.reset();
    if (begin_ == end_) begin_ = end_ = 0;
    enter(Phase::idle);
  }
  if (!out_.empty() && !flush_now({})) co_await write_out({});
  if (upgrade_ && socket_.is_open()) {
    std::string early = buffer_.substr(begin_, end_ - begin_);
    std::string().swap(buffer_);
    std::string().swap(out_);
    websocket_ =
        std::make_shared<WebSocket>(std::move(socket_), std::move(upgrade_), service_.options.websocket,
                                    handshake_.compression, std::move(handshake_.subprotocol), remote_);
    service_.stats.websockets++;
    co_await websocket_->run(std::move(early));
    service_.stats.websockets--;
  } else if (unread_ && socket_.is_open()) {
    co_await linger();
  }
  abort();
}

void Connection::make_room() {
  if (begin_ > 0 && (begin_ == end_ || end_ == buffer_.size())) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
}

asio::awaitable<size_t> Connection::read_into(char* to, size_t size) {
  boost::system::error_code ec;
  const size_t n =
      co_await socket_.async_read_some(asio::buffer(to, size), asio::redirect_error(asio::use_awaitable, ec));
  co_return ec ? 0 : n;
}

// More bytes of a head. The buffer grows to the head's limit at most: the parser refuses longer ones.
asio::awaitable<bool> Connection::read_more() {
  make_room();
  boost::system::error_code ec;
  const size_t n =
      co_await socket_.async_read_some(asio::buffer(buffer_.data() + end_, buffer_.size() - end_),
                                       asio::redirect_error(asio::use_awaitable, ec));
  end_ += n;
  if (ec && timed_out_ && phase_ == Phase::head) refuse(408, "the request's head took too long to arrive");
  co_return !ec;
}

asio::awaitable<bool> Connection::read_body(size_t limit) {
  if (parser_.framing() == Framing::length && parser_.content_length() > limit) {
    refuse(413, "the body is larger than " + std::to_string(limit) + " bytes");
    co_return false;
  }
  enter(Phase::body);
  if (parser_.expects_continue() && begin_ == end_) {
    out_ += "HTTP/1.1 100 Continue\r\n\r\n";
    if (!flush_now({})) {
      if (!co_await write_out({})) co_return false;
    }
    enter(Phase::body);
  }
  bool complete = false;
  if (parser_.framing() == Framing::chunked) {
    complete = co_await read_chunked(limit);
  } else {
    complete = co_await read_sized(static_cast<size_t>(parser_.content_length()));
  }
  if (!complete && timed_out_) refuse(408, "the request's body took too long to arrive");
  phase_ = Phase::handler;
  deadline_ = Clock::time_point::max();
  co_return complete;
}

asio::awaitable<bool> Connection::read_sized(size_t size) {
  std::string& body = request_.body;
  size_t have = std::min(size, end_ - begin_);
  body.assign(buffer_.data() + begin_, have);
  begin_ += have;
  while (have < size) {
    // Memory follows what has arrived, not what was announced.
    if (have == body.size()) body.resize(std::min(size, std::max<size_t>(2 * have, 65536)));
    const size_t n = co_await read_into(body.data() + have, body.size() - have);
    if (n == 0) co_return false;
    have += n;
    deadline_ += std::chrono::microseconds(n * 1000000 / kBodyBytesPerSecond);
  }
  co_return true;
}

asio::awaitable<bool> Connection::read_chunked(size_t limit) {
  ChunkDecoder decoder(limit);
  for (;;) {
    size_t used = 0;
    const size_t before = request_.body.size();
    const auto result = decoder.feed({buffer_.data() + begin_, end_ - begin_}, request_.body, used);
    begin_ += used;
    deadline_ += std::chrono::microseconds((request_.body.size() - before) * 1000000 / kBodyBytesPerSecond);
    if (result == ChunkDecoder::Result::done) co_return true;
    if (result == ChunkDecoder::Result::bad) {
      refuse(400, "the chunked body is malformed");
      co_return false;
    }
    if (result == ChunkDecoder::Result::too_large) {
      refuse(413, "the body is larger than " + std::to_string(limit) + " bytes");
      co_return false;
    }
    make_room();
    const size_t n = co_await read_into(buffer_.data() + end_, buffer_.size() - end_);
    if (n == 0) co_return false;
    end_ += n;
  }
}

Response Connection::answer(const Route& route) {
  try {
    return route.handler(request_);
  } catch (const Error& e) {
    return problem(request_, e);
  } catch (const std::exception& e) {
    return problem(request_, e);
  }
}

asio::awaitable<Response> Connection::wait_for(const Route& route) {
  phase_ = Phase::handler;
  deadline_ = Clock::time_point::max();
  try {
    co_return co_await asio::co_spawn(
        socket_.get_executor(), route.async_handler(request_),
        asio::bind_cancellation_slot(cancel_handler_.slot(), asio::use_awaitable));
  } catch (const Error& e) {
    co_return problem(request_, e);
  } catch (const std::exception& e) {
    if (service_.draining) co_return problem(request_, "draining", "the service is shutting down");
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

// Queues a response after which the connection ends although the peer may still be sending.
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

// On success upgrade_ is set and the 101 queued.
Response Connection::open_websocket(const Route& route) {
  if (auto refused = check_handshake(request_, parser_, route, handshake_)) return std::move(*refused);
  if (service_.draining) return problem(request_, "draining", "the service is shutting down");
  try {
    upgrade_ = route.open_websocket(request_);
  } catch (const Error& e) {
    return problem(request_, e);
  } catch (const std::exception& e) {
    return problem(request_, e);
  }
  out_ += handshake_.head;
  return {};
}

}  // namespace truestep::net
