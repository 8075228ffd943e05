// What follows the handshake of a WebSocket: sending, receiving, closing.
#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "engine/base/text/utf8.h"
#include "server/net/websocket/beast_websocket.h"

namespace truestep::net {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;

namespace {

// A receive buffer larger than this is freed after its message.
constexpr size_t kKeptBuffer = 65536;
// Room for one read, as much as the message already has: Beast would trust the length that a compressed frame
// claims, and its own guess asserts when a message ends in the middle of a read.
constexpr size_t kFirstRead = 4096, kReadAtOnce = 65536;
constexpr uint16_t kNoCode = 1005, kLost = 1006;

size_t size_of(const MessageParts& parts) {
  return (parts[0] ? parts[0]->size() : 0) + (parts[1] ? parts[1]->size() : 0);
}

asio::const_buffer buffer_of(const SharedBuffer& part) {
  return part ? asio::buffer(*part) : asio::const_buffer();
}

// What a close frame can hold, cut on a character boundary.
std::string_view cut_reason(std::string_view reason) {
  size_t n = std::min(reason.size(), websocket::reason_string::static_capacity);
  while (n > 0 && n < reason.size() && (static_cast<unsigned char>(reason[n]) & 0xC0) == 0x80) --n;
  return reason.substr(0, n);
}

// The code that Beast has closed with after this error.
uint16_t code_of(const boost::system::error_code& ec) {
  if (ec == websocket::error::message_too_big) return 1009;
  if (ec == websocket::error::bad_frame_payload) return 1007;
  return ec == websocket::condition::protocol_violation ? 1002 : kLost;
}

}  // namespace

// --- sending

bool BeastWebSocket::send(MessageKind kind, MessageParts parts) {
  if (closing_.load(std::memory_order_acquire)) return false;
  const size_t size = size_of(parts);
  size_t queued = queued_.load(std::memory_order_relaxed);
  do {
    if (queued > 0 && queued + size > limits_.max_queue) return false;
  } while (!queued_.compare_exchange_weak(queued, queued + size));
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back({kind, std::move(parts)});
    if (std::exchange(writing_, true)) return true;
  }
  asio::dispatch(ws_.get_executor(), [self = shared_from_this()] { self->write_next(); });
  return true;
}

void BeastWebSocket::write_next() {
  // Nothing follows a close frame; what another thread has queued meanwhile ends with the connection.
  if (close_sent_) return;
  bool idle = false;
  {
    const std::lock_guard lock(mutex_);
    idle = queue_.empty();
    writing_ = !idle;
    if (!idle) {
      current_ = std::move(queue_.front());
      queue_.pop_front();
    }
  }
  if (idle) {
    if (close_due_) return send_close();
    if (handler_) handler_->on_drain();
    return;
  }
  ws_.binary(current_.kind == MessageKind::binary);
  const std::array<asio::const_buffer, 2> parts{buffer_of(current_.parts[0]), buffer_of(current_.parts[1])};
  ws_.async_write(parts, [self = shared_from_this()](const boost::system::error_code& ec, size_t) {
    self->queued_ -= size_of(self->current_.parts);
    self->current_ = {};
    // After an error nothing more is written; the reader sees it too and ends.
    if (!ec) self->write_next();
  });
}

void BeastWebSocket::close(uint16_t code, std::string_view reason) {
  if (closing_.exchange(true)) return;
  asio::dispatch(ws_.get_executor(), [self = shared_from_this(), code, text = std::string(reason)] {
    self->start_close(code, text);
  });
}

void BeastWebSocket::start_close(uint16_t code, std::string_view reason) {
  if (!open_) return abort();
  end_code_ = code;
  end_reason_ = cut_reason(reason);
  ws_.next_layer().deadline = Clock::now() + limits_.close_wait;
  {
    const std::lock_guard lock(mutex_);
    close_due_ = writing_;
  }
  if (!close_due_) send_close();
}

void BeastWebSocket::send_close() {
  close_due_ = false;
  if (std::exchange(close_sent_, true)) return;
  ws_.next_layer().deadline = Clock::now() + limits_.close_wait;
  const websocket::close_reason reason(static_cast<websocket::close_code>(end_code_), end_reason_);
  ws_.async_close(
      reason, asio::bind_cancellation_slot(stop_closing_.slot(),
                                           [self = shared_from_this()](const boost::system::error_code&) {}));
}

// --- receiving

Task<> BeastWebSocket::run() {
  const auto self = shared_from_this();
  co_await Io([&](const Resume& handler) { ws_.next_layer().async_wait(Socket::wait_write, handler); });
  if (accept()) {
    abort();
    co_return;
  }
  open_ = true;
  try {
    handler_->on_open(self);
  } catch (const std::exception& e) {
    log_error("stream of {}: {}", remote_, e.what());
    close(1011, "internal error");
  }
  boost::beast::flat_buffer message;
  for (;;) {
    const auto room = message.prepare(std::clamp(message.size(), kFirstRead, kReadAtOnce));
    const auto [error, bytes] = co_await Io([&](const Resume& handler) {
      ws_.async_read_some(room, asio::bind_cancellation_slot(stop_reading_.slot(), handler));
    });
    message.commit(bytes);
    if (error) co_return end(error);
    if (!ws_.is_message_done()) continue;
    if (is_open()) deliver({static_cast<const char*>(message.data().data()), message.size()});
    message.clear();
    if (message.capacity() > kKeptBuffer) message.shrink_to_fit();
  }
}

void BeastWebSocket::deliver(std::string_view message) {
  // Beast validates while it reads, so an empty last fragment can hide an incomplete character.
  if (ws_.got_text() && !valid_utf8(message)) return close(1007, "the text ends inside a character");
  try {
    handler_->on_message(ws_.got_text() ? MessageKind::text : MessageKind::binary, message);
  } catch (const Error& e) {
    close(1008, e.what());
  } catch (const std::exception& e) {
    log_error("stream of {}: {}", remote_, e.what());
    close(1011, "internal error");
  }
}

void BeastWebSocket::end(const boost::system::error_code& ec) {
  open_ = false;
  closing_ = true;
  if (end_code_ == 0 && ec == websocket::error::closed) {
    end_code_ = ws_.reason().code == websocket::close_code::none ? kNoCode : ws_.reason().code;
    end_reason_ = ws_.reason().reason.c_str();
  } else if (end_code_ == 0) {
    end_code_ = code_of(ec);
  }
  abort();
  {
    const std::lock_guard lock(mutex_);
    queue_.clear();
  }
  const auto handler = std::exchange(handler_, nullptr);
  handler->on_close(end_code_, end_reason_);
}

void BeastWebSocket::tick(Clock::time_point now) {
  const Wire& wire = ws_.next_layer();
  const bool writing = current_.parts[0] != nullptr;
  if (now > wire.deadline || (writing && now - wire.last_write > limits_.stall)) return abort();
  // A peer that does not read cannot be expected to answer: the stall limit above covers it.
  if (!open_ || writing) return;
  const auto silence = now - wire.last_read;
  const bool asked = ping_sent_ > wire.last_read;
  if (asked && now - ping_sent_ > limits_.ping_interval + std::chrono::seconds(1)) {
    abort();
  } else if (!asked && !pinging_ && silence > limits_.ping_interval) {
    ping_sent_ = now;
    pinging_ = true;
    ws_.async_ping({},
                   [self = shared_from_this()](const boost::system::error_code&) { self->pinging_ = false; });
  }
}

void BeastWebSocket::abort() {
  boost::system::error_code ec;
  closing_ = true;
  ws_.next_layer().close(ec);
  // A frame that breaks the rules while we are closing: Beast's reading and closing wait for each other, not
  // for the socket, and only this ends them. Posted, because they may complete at once while our callers are
  // not done.
  asio::post(ws_.get_executor(), [self = shared_from_this()] {
    self->stop_reading_.emit(asio::cancellation_type::terminal);
    self->stop_closing_.emit(asio::cancellation_type::terminal);
  });
}

}  // namespace truestep::net
