// A WebSocket served by us on top of Beast: whatever a client sends after the handshake, in pieces (the first
// byte of the input is their length), the conversation ends once, and what is echoed is valid.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/text/utf8.h"
#include "server/net/event_loop.h"
#include "server/net/http/request_parser.h"
#include "server/net/websocket/websocket_stream.h"

namespace {

using namespace truestep::net;

constexpr char kHandshake[] =
    "GET / HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Extensions: permessage-deflate\r\n\r\n";

constexpr WebSocketLimits kLimits{.max_message = 1 << 12};

class Echo : public WebSocketHandler {
 public:
  explicit Echo(int& ends) : ends_(ends) {}
  void on_open(std::shared_ptr<WebSocket> socket) override { socket_ = std::move(socket); }
  void on_message(MessageKind kind, std::string_view payload) override {
    if (ends_ != 0 || (kind == MessageKind::text && !truestep::valid_utf8(payload))) __builtin_trap();
    socket_->send(kind, {std::make_shared<const std::string>(payload), nullptr});
  }
  void on_close(uint16_t code, std::string_view) override {
    if (code < 1000 || code > 4999) __builtin_trap();
    ++ends_;
  }

 private:
  int& ends_;
  std::shared_ptr<WebSocket> socket_;
};

void drain(int fd) {
  char scratch[65536];
  while (::recv(fd, scratch, sizeof scratch, MSG_DONTWAIT) > 0) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair) != 0) return 0;
  Request request;
  RequestParser(request, 4096).feed(kHandshake);
  int ends = 0;
  {
    EventLoop loop;
    auto& io = loop.io();
    truestep::TaskContext context(loop);
    const auto socket = make_websocket(Socket(io, boost::asio::ip::tcp::v4(), pair[0]), request,
                                       std::make_shared<Echo>(ends), kLimits, "");
    truestep::RootTask task(socket->run(), context, [](const std::exception_ptr&) {});
    task.start();
    io.poll();
    const size_t piece = std::max<size_t>(1, data[0]);
    for (size_t at = 1; at < size; at += piece) {
      if (::send(pair[1], data + at, std::min(piece, size - at), MSG_NOSIGNAL) < 0) break;
      io.poll();
      drain(pair[1]);
    }
    ::shutdown(pair[1], SHUT_WR);
    for (int i = 0; i < 1000 && ends == 0; ++i) {
      // Once everything has been fed: past the time that closing may take.
      if (i == 500) socket->tick(Clock::now() + kLimits.close_wait + std::chrono::seconds(1));
      io.poll();
      drain(pair[1]);
    }
  }
  ::close(pair[1]);
  if (ends != 1) __builtin_trap();
  return 0;
}
