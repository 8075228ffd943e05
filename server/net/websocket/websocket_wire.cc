#include "server/net/websocket/websocket_wire.h"

namespace truestep::net {

namespace {

/// Reads what nobody will look at, up to the end.
struct ReadOn {
  Wire& wire;
  AnyHandler handler;
  std::unique_ptr<std::array<char, 4096>> scratch = std::make_unique<std::array<char, 4096>>();

  void operator()(const boost::system::error_code& error, size_t) {
    if (error) return handler({}, 0);
    const auto buffer = boost::asio::buffer(*scratch);
    static_cast<Socket&>(wire).async_read_some(buffer, std::move(*this));
  }
};

}  // namespace

void Wire::read(const FirstBuffers<boost::asio::mutable_buffer>& buffers, AnyHandler handler) {
  last_read = Clock::now();
  Socket::async_read_some(buffers, std::move(handler));
}

void Wire::write(const FirstBuffers<boost::asio::const_buffer>& buffers, AnyHandler handler) {
  last_write = Clock::now();
  Socket::async_write_some(buffers, std::move(handler));
}

size_t Wire::write_now(const FirstBuffers<boost::asio::const_buffer>& buffers,
                       boost::system::error_code& ec) {
  last_write = Clock::now();
  return Socket::write_some(buffers, ec);
}

void Wire::finish(AnyHandler handler) {
  deadline = std::min(deadline, Clock::now() + linger_);
  boost::system::error_code ec;
  shutdown(shutdown_send, ec);
  ReadOn(*this, std::move(handler))(boost::system::error_code(), 0);
}

}  // namespace truestep::net
