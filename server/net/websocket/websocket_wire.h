// The socket beneath a Beast WebSocket: remembers when bytes last moved, and closes gently. Beast's own
// teardown closes with unread bytes in the socket, and the reset that follows may overtake the close frame.
#pragma once
#include <algorithm>
#include <array>
#include <boost/asio/compose.hpp>
#include <boost/beast/core/role.hpp>
#include <memory>
#include <utility>

#include "server/net/websocket/websocket_stream.h"

namespace truestep::net {

class Wire : public Socket {
 public:
  Wire(Socket socket, Clock::duration linger) : Socket(std::move(socket)), linger_(linger) {}

  // The next read or write starts when the previous one has returned something.
  template <class Buffers, class Handler>
  auto async_read_some(const Buffers& buffers, Handler&& handler) {
    last_read = Clock::now();
    return Socket::async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  auto async_write_some(const Buffers& buffers, Handler&& handler) {
    last_write = Clock::now();
    return Socket::async_write_some(buffers, std::forward<Handler>(handler));
  }

  /// Shuts down sending and reads until the peer does the same; cut short by the deadline.
  template <class Handler>
  void async_finish(Handler&& handler) {
    deadline = std::min(deadline, Clock::now() + linger_);
    boost::system::error_code ec;
    shutdown(shutdown_send, ec);
    auto scratch = std::make_unique<std::array<char, 4096>>();
    auto read_on = [this, scratch = std::move(scratch)](auto& self, boost::system::error_code ec = {},
                                                        size_t = 0) mutable {
      if (ec) return self.complete({});
      // Not a temporary of the call, which is moved from when the handler is.
      const auto buffer = boost::asio::buffer(*scratch);
      Socket::async_read_some(buffer, std::move(self));
    };
    boost::asio::async_compose<Handler, void(boost::system::error_code)>(std::move(read_on), handler, *this);
  }

  Clock::time_point last_read = Clock::now(), last_write = last_read, deadline = Clock::time_point::max();

 private:
  Clock::duration linger_;
};

/// Found by Beast instead of its own.
template <class Handler>
void async_teardown(boost::beast::role_type, Wire& wire, Handler&& handler) {
  wire.async_finish(std::forward<Handler>(handler));
}

}  // namespace truestep::net
