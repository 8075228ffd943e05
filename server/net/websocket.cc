#include "server/net/websocket.h"

#include <sys/socket.h>
#include <sys/uio.h>

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <cerrno>

#include "engine/base/errors.h"
#include "engine/base/log.h"

namespace truestep::net {

namespace asio = boost::asio;

namespace {

constexpr size_t kReadBuffer = 4096;
constexpr size_t kReadBufferMax = 65536;
// Bytes written in one go before other connections get their turn.
constexpr size_t kFairShare = size_t{4} << 20;

}  // namespace

WebSocket::WebSocket(Socket socket, std::shared_ptr<WebSocketHandler> handler, WebSocketLimits limits,
                     Compression compression, std::string subprotocol, std::string remote)
    : socket_(std::move(socket)),
      handler_(std::move(handler)),
      limits_(limits),
      subprotocol_(std::move(subprotocol)),
      remote_(std::move(remote)),
      decoder_(limits.max_message, compression),
      last_read_(Clock::now()),
      last_write_(last_read_),
      ping_sent_(last_read_),
      deadline_(Clock::time_point::max()),
      flushed_(socket_.get_executor()) {}

bool WebSocket::send(Opcode opcode, SharedBuffer payload) {
  if (closing_.load(std::memory_order_acquire)) return false;
  const size_t size = payload->size();
  size_t queued = queued_.load(std::memory_order_relaxed);
  do {
    if (queued > 0 && queued + size > limits_.max_queue) return false;
  } while (!queued_.compare_exchange_weak(queued, queued + size));
  if (socket_.get_executor().running_in_this_thread()) {
    enqueue(opcode, std::move(payload));
    if (!batching_) flush();
    return true;
  }
  const std::lock_guard lock(inbox_mutex_);
  inbox_.push_back({encode_frame_head(opcode, size), std::move(payload), opcode});
  if (!inbox_posted_) {
    inbox_posted_ = true;
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->take_inbox(); });
  }
  return true;
}

void WebSocket::take_inbox() {
  std::deque<Outgoing> arrived;
  {
    const std::lock_guard lock(inbox_mutex_);
    arrived.swap(inbox_);
    inbox_posted_ = false;
  }
  for (Outgoing& o : arrived) {
    if (o.opcode == Opcode::close) {
      const std::string& p = *o.payload;
      start_close(static_cast<uint16_t>(static_cast<uint8_t>(p[0]) << 8 | static_cast<uint8_t>(p[1])),
                  std::string_view(p).substr(2));
    } else {
      enqueue(o.opcode, std::move(o.payload));
    }
  }
  flush();
}

void WebSocket::enqueue(Opcode opcode, SharedBuffer payload) {
  if (stage_ != Stage::open) {
    queued_ -= payload->size();
    return;
  }
  if (wire_.empty()) last_write_ = Clock::now();
  wire_.push_back({encode_frame_head(opcode, payload->size()), std::move(payload), opcode});
}

void WebSocket::enqueue_control(Opcode opcode, std::string_view payload) {
  const size_t first = front_written_ > 0 ? 1 : 0;
  // Only the latest ping needs an answer (RFC 6455 section 5.5.3), so a flood of pings queues one pong.
  if (opcode == Opcode::pong) {
    for (size_t i = first; i < wire_.size() && i < first + controls_; ++i) {
      if (wire_[i].opcode == Opcode::pong) {
        wire_[i].head = encode_frame_head(opcode, payload.size());
        wire_[i].payload = std::make_shared<const std::string>(payload);
        return;
      }
    }
  }
  if (wire_.empty()) last_write_ = Clock::now();
  Outgoing frame{encode_frame_head(opcode, payload.size()), std::make_shared<const std::string>(payload),
                 opcode};
  if (opcode == Opcode::close) {
    wire_.push_back(std::move(frame));
  } else {
    wire_.insert(wire_.begin() + static_cast<long>(std::min(wire_.size(), first + controls_)),
                 std::move(frame));
    ++controls_;
  }
}

// Forgets every frame of which no byte has been written yet.
void WebSocket::drop_waiting() {
  const size_t keep = front_written_ > 0 ? 1 : 0;
  for (size_t i = keep; i < wire_.size(); ++i) {
    if (wire_[i].opcode == Opcode::text || wire_[i].opcode == Opcode::binary)
      queued_ -= wire_[i].payload->size();
  }
  wire_.resize(std::min(wire_.size(), keep));
  controls_ = 0;
}

void WebSocket::flush() {
  if (waiting_ || !socket_.is_open()) return;
  size_t total = 0;
  while (!wire_.empty()) {
    constexpr size_t kVectors = 64;
    iovec iov[kVectors];
    size_t n = 0, skip = front_written_;
    for (auto it = wire_.begin(); it != wire_.end() && n + 2 <= kVectors; ++it) {
      if (skip < it->head.size) {
        iov[n++] = {it->head.bytes.data() + skip, it->head.size - skip};
        skip = 0;
      } else {
        skip -= it->head.size;
      }
      if (it->payload->size() > skip)
        iov[n++] = {const_cast<char*>(it->payload->data()) + skip, it->payload->size() - skip};
      skip = 0;
    }
    msghdr message{};
    message.msg_iov = iov;
    message.msg_iovlen = n;
    const ssize_t written = ::sendmsg(socket_.native_handle(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (written < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK) {
        abort();
        return;
      }
      waiting_ = true;
      socket_.async_wait(Socket::wait_write,
                         [self = shared_from_this()](const boost::system::error_code& ec) {
                           self->waiting_ = false;
                           if (!ec) self->flush();
                         });
      return;
    }
    last_write_ = Clock::now();
    consume(static_cast<size_t>(written));
    total += static_cast<size_t>(written);
    if (total > kFairShare && !wire_.empty()) {
      asio::post(socket_.get_executor(), [self = shared_from_this()] { self->flush(); });
      return;
    }
  }
  flushed_.cancel();
  if (drain_due_ && stage_ == Stage::open) {
    drain_due_ = false;
    asio::post(socket_.get_executor(), [self = shared_from_this()] {
      if (self->stage_ == Stage::open && self->handler_) self->handler_->on_drain();
    });
  }
}

void WebSocket::consume(size_t written) {
  front_written_ += written;
  while (!wire_.empty() && front_written_ >= wire_.front().size()) {
    Outgoing& done = wire_.front();
    front_written_ -= done.size();
    if (done.opcode == Opcode::text || done.opcode == Opcode::binary) {
      queued_ -= done.payload->size();
      drain_due_ = true;
    } else if (controls_ > 0) {
      --controls_;
    }
    wire_.pop_front();
  }
}

void WebSocket::close(uint16_t code, std::string_view reason) {
  if (closing_.exchange(true)) return;
  if (socket_.get_executor().running_in_this_thread()) {
    start_close(code, reason);
    if (!batching_) flush();
    return;
  }
  const std::lock_guard lock(inbox_mutex_);
  auto payload = std::make_shared<const std::string>(close_payload(code, reason));
  inbox_.push_back({encode_frame_head(Opcode::close, payload->size()), std::move(payload), Opcode::close});
  if (!inbox_posted_) {
    inbox_posted_ = true;
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->take_inbox(); });
  }
}

void WebSocket::start_close(uint16_t code, std::string_view reason) {
  closing_ = true;
  if (stage_ != Stage::open) return;
  stage_ = Stage::close_sent;
  end_code_ = code;
  end_reason_ = reason;
  deadline_ = Clock::now() + limits_.close_wait;
  enqueue_control(Opcode::close, close_payload(code, reason));
}

bool WebSocket::handle(FrameDecoder::Event event) {
  using Event = FrameDecoder::Event;
  switch (event) {
    case Event::need_more:
      return true;
    case Event::text:
    case Event::binary:
      if (stage_ != Stage::open) return true;
      try {
        handler_->on_message(event == Event::text ? MessageKind::text : MessageKind::binary,
                             decoder_.payload());
      } catch (const Error& e) {
        close(1008, e.what());
      } catch (const std::exception& e) {
        spdlog::error("stream of {}: {}", remote_, e.what());
        close(1011, "internal error");
      }
      return true;
    case Event::ping:
      if (stage_ == Stage::open) enqueue_control(Opcode::pong, decoder_.payload());
      return true;
    case Event::pong:
      return true;
    case Event::close: {
      const uint16_t code = decoder_.close_code();
      if (stage_ == Stage::open) {
        closing_ = true;
        end_code_ = code;
        end_reason_ = decoder_.close_reason();
        drop_waiting();
        enqueue_control(Opcode::close, code == 1005 ? std::string() : close_payload(code, {}));
      }
      return false;
    }
    case Event::violation:
      closing_ = true;
      drop_waiting();
      if (stage_ == Stage::open) {
        end_code_ = decoder_.violation_code();
        end_reason_ = decoder_.violation_reason();
        enqueue_control(Opcode::close, close_payload(end_code_, end_reason_));
      }
      return false;
  }
  return false;
}

// Handles everything in the bytes; false when the conversation is over.
bool WebSocket::dispatch(char* data, size_t size) {
  batching_ = true;
  bool going = true;
  while (going) {
    const FrameDecoder::Event event = decoder_.next(data, size);
    going = handle(event);
    if (event == FrameDecoder::Event::need_more) break;
  }
  batching_ = false;
  flush();
  return going;
}

asio::awaitable<void> WebSocket::run(std::string early) {
  const auto self = shared_from_this();
  boost::system::error_code ec;
  try {
    handler_->on_open(self);
  } catch (const std::exception& e) {
    spdlog::error("stream of {}: {}", remote_, e.what());
    close(1011, "internal error");
  }
  bool going = dispatch(early.data(), early.size());
  std::string().swap(early);
  std::string buffer(kReadBuffer, '\0');
  while (going && socket_.is_open()) {
    const size_t n =
        co_await socket_.async_read_some(asio::buffer(buffer), asio::redirect_error(asio::use_awaitable, ec));
    if (ec) break;
    last_read_ = Clock::now();
    going = dispatch(buffer.data(), n);
    if (n == buffer.size() && n < kReadBufferMax) buffer.resize(4 * n);
  }
  if (!going) co_await finish();
  closing_ = true;
  stage_ = Stage::finishing;
  abort();
  drop_waiting();
  report(end_code_, end_reason_);
}

// The close frame is on its way out: let it arrive before the connection is torn down. Unread bytes would
// turn the end into a reset that may overtake it, hence the reading.
asio::awaitable<void> WebSocket::finish() {
  boost::system::error_code ec;
  stage_ = Stage::finishing;
  deadline_ = Clock::now() + limits_.close_wait;
  if (!wire_.empty()) {
    flushed_.expires_after(limits_.close_wait);
    co_await flushed_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
  if (!socket_.is_open()) co_return;
  socket_.shutdown(Socket::shutdown_send, ec);
  std::string scratch(kReadBuffer, '\0');
  ec = {};
  while (!ec && socket_.is_open()) {
    co_await socket_.async_read_some(asio::buffer(scratch), asio::redirect_error(asio::use_awaitable, ec));
  }
}

void WebSocket::tick(Clock::time_point now) {
  if (now > deadline_ || (!wire_.empty() && now - last_write_ > limits_.stall)) {
    abort();
    return;
  }
  // A peer that does not read cannot be expected to answer: the stall limit above is for it.
  if (stage_ != Stage::open || !wire_.empty()) return;
  const auto silence = now - last_read_;
  if (silence > 2 * limits_.ping_interval + std::chrono::seconds(1) && ping_sent_ > last_read_ &&
      now - ping_sent_ > limits_.ping_interval) {
    abort();
  } else if (silence > limits_.ping_interval && now - ping_sent_ > limits_.ping_interval) {
    ping_sent_ = now;
    enqueue_control(Opcode::ping, {});
    flush();
  }
}

void WebSocket::abort() {
  boost::system::error_code ec;
  closing_ = true;
  if (socket_.is_open()) socket_.close(ec);
  flushed_.cancel();
}

void WebSocket::report(uint16_t code, std::string_view reason) {
  if (!handler_) return;
  const auto handler = std::move(handler_);
  handler_.reset();
  handler->on_close(code, reason);
}

}  // namespace truestep::net
