// The socket beneath a Beast WebSocket: remembers when bytes last moved, and closes gently. Beast's own
// teardown closes with unread bytes in the socket, and the reset that follows may overtake the close frame.
// Beast reads and writes with dozens of types of handlers and buffers; the socket is given one of each, which
// is two fifths of the compiler's time.
#pragma once
#include <algorithm>
#include <array>
#include <boost/beast/core/role.hpp>
#include <memory>
#include <utility>

#include "server/net/websocket/websocket_stream.h"

namespace truestep::net {

/// A handler of any type.
class AnyHandler {
 public:
  template <class Handler>
  // NOLINTNEXTLINE(bugprone-forwarding-reference-overload)
  requires(!std::is_same_v<std::decay_t<Handler>, AnyHandler>) explicit AnyHandler(Handler&& handler)
      : call_(std::make_unique<Held<std::decay_t<Handler>>>(std::forward<Handler>(handler))) {}
  void operator()(const boost::system::error_code& error, size_t bytes) {
    const std::unique_ptr<Call> call = std::move(call_);
    call->run(error, bytes);
  }

 private:
  struct Call {
    virtual ~Call() = default;
    virtual void run(const boost::system::error_code& error, size_t bytes) = 0;
  };
  template <class Handler>
  struct Held final : Call {
    explicit Held(Handler&& h) : handler(std::move(h)) {}
    void run(const boost::system::error_code& error, size_t bytes) override { handler(error, bytes); }
    Handler handler;
  };
  std::unique_ptr<Call> call_;
};

/// The first buffers of a sequence of any type: enough for an operation that may take less than all.
template <class Buffer>
class FirstBuffers {
 public:
  using value_type = Buffer;
  using const_iterator = const Buffer*;
  template <class Buffers>
  explicit FirstBuffers(const Buffers& all) {
    const auto last = boost::asio::buffer_sequence_end(all);
    for (auto b = boost::asio::buffer_sequence_begin(all); b != last && count_ < buffers_.size(); ++b) {
      if (const Buffer buffer = *b; buffer.size() > 0) buffers_[count_++] = buffer;
    }
  }
  const Buffer* begin() const { return buffers_.data(); }
  const Buffer* end() const { return buffers_.data() + count_; }

 private:
  std::array<Buffer, 8> buffers_;
  size_t count_ = 0;
};

class Wire : public Socket {
 public:
  Wire(Socket socket, Clock::duration linger) : Socket(std::move(socket)), linger_(linger) {}

  // The next read or write starts when the previous one has returned something.
  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read(FirstBuffers<boost::asio::mutable_buffer>(buffers), AnyHandler(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write(FirstBuffers<boost::asio::const_buffer>(buffers), AnyHandler(std::forward<Handler>(handler)));
  }

  using Socket::read_some;
  using Socket::write_some;
  template <class Buffers>
  size_t write_some(const Buffers& buffers, boost::system::error_code& ec) {
    return write_now(FirstBuffers<boost::asio::const_buffer>(buffers), ec);
  }

  /// Shuts down sending and reads until the peer does the same; cut short by the deadline.
  void finish(AnyHandler handler);

  Clock::time_point last_read = Clock::now(), last_write = last_read, deadline = Clock::time_point::max();

 private:
  void read(const FirstBuffers<boost::asio::mutable_buffer>& buffers, AnyHandler handler);
  void write(const FirstBuffers<boost::asio::const_buffer>& buffers, AnyHandler handler);
  size_t write_now(const FirstBuffers<boost::asio::const_buffer>& buffers, boost::system::error_code& ec);
  Clock::duration linger_;
};

/// Found by Beast instead of its own.
template <class Handler>
void async_teardown(boost::beast::role_type, Wire& wire, Handler&& handler) {
  wire.finish(AnyHandler([h = std::forward<Handler>(handler)](const boost::system::error_code& error,
                                                              size_t) mutable { h(error); }));
}

}  // namespace truestep::net
