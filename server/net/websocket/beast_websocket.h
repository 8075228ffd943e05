// A WebSocket on top of Beast's: for the two files that instantiate its templates, one to answer the
// handshake and one for all that follows.
#pragma once
#include <atomic>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <mutex>
#include <utility>

#include "server/net/websocket/websocket_stream.h"
#include "server/net/websocket/websocket_wire.h"

namespace truestep::net {

class BeastWebSocket final : public ServedWebSocket, public std::enable_shared_from_this<BeastWebSocket> {
 public:
  BeastWebSocket(Socket socket, const Request& request, std::shared_ptr<WebSocketHandler> handler,
                 WebSocketLimits limits, std::string subprotocol);

  bool send(MessageKind kind, MessageParts parts) override;
  void close(uint16_t code, std::string_view reason) override;
  size_t queued_bytes() const override { return queued_.load(std::memory_order_relaxed); }
  bool is_open() const override { return !closing_.load(std::memory_order_relaxed); }
  const std::string& subprotocol() const override { return subprotocol_; }
  const std::string& remote() const override { return remote_; }

  Task<> run() override;
  void tick(Clock::time_point now) override;
  void abort() override;

 private:
  struct Outgoing {
    MessageKind kind;
    MessageParts parts;
  };

  /// Answers the handshake.
  boost::system::error_code accept();
  void write_next();
  void start_close(uint16_t code, std::string_view reason);
  void send_close();
  void deliver(std::string_view message);
  void end(const boost::system::error_code& ec);

  boost::beast::websocket::stream<Wire> ws_;
  boost::beast::http::request<boost::beast::http::empty_body> handshake_;
  std::shared_ptr<WebSocketHandler> handler_;
  const WebSocketLimits limits_;
  const std::string subprotocol_, remote_;

  std::mutex mutex_;
  std::deque<Outgoing> queue_;
  bool writing_ = false;  ///< write_next is under way or posted
  std::atomic<size_t> queued_{0};
  std::atomic<bool> closing_{false};

  Outgoing current_;  ///< on its way; from here on network thread only
  bool open_ = false, pinging_ = false, close_due_ = false, close_sent_ = false;
  Clock::time_point ping_sent_ = Clock::now();
  uint16_t end_code_ = 0;
  std::string end_reason_;
  boost::asio::cancellation_signal stop_reading_, stop_closing_;
};

}  // namespace truestep::net
