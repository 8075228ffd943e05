// One WebSocket: what a session's stream holds to send, and what it implements to receive. Outgoing messages
// are shared buffers in a queue bounded in bytes; what to do when the queue is long (drop, skip, close) is
// the owner's policy: it reads queued_bytes() and is told when the queue has run empty. Pings and pongs are
// answered here and overtake waiting messages. Any thread may send and close; the handler is called on the
// network thread only.
#pragma once
#include <array>
#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "server/net/message.h"
#include "server/net/websocket_frame.h"

namespace truestep::net {

using Socket = boost::asio::basic_stream_socket<boost::asio::ip::tcp, boost::asio::io_context::executor_type>;
using Clock = std::chrono::steady_clock;

enum class MessageKind : uint8_t { text, binary };

class WebSocket;

/// What the owner implements. All calls come from the network thread, one at a time; they must not block.
class WebSocketHandler {
 public:
  virtual ~WebSocketHandler() = default;
  /// The handshake is done; `socket` may be kept.
  virtual void on_open(std::shared_ptr<WebSocket> socket) = 0;
  /// One complete message. Error thrown from here closes with 1008 and its text, anything else with 1011.
  virtual void on_message(MessageKind kind, std::string_view payload) = 0;
  /// Everything that was queued has been handed to the kernel.
  virtual void on_drain() {}
  /// The last call: 1006 when the connection was lost without a close frame, 1005 when it held no code.
  virtual void on_close(uint16_t code, std::string_view reason) {}
};

struct WebSocketLimits {
  size_t max_message = size_t{1} << 20;    ///< bytes of a received message
  size_t max_queue = size_t{64} << 20;     ///< bytes waiting to be sent
  std::chrono::seconds stall{120};         ///< nothing could be written for so long: cut
  std::chrono::seconds ping_interval{20};  ///< after silence; twice that without any byte: cut
  std::chrono::seconds close_wait{3};      ///< for the peer's close frame and the last bytes
};

class WebSocket : public std::enable_shared_from_this<WebSocket> {
 public:
  WebSocket(Socket socket, std::shared_ptr<WebSocketHandler> handler, WebSocketLimits limits,
            Compression compression, std::string subprotocol, std::string remote);

  /// Queues one message. False, and nothing is queued, when the socket is closing or the queue would exceed
  /// its limit (one message of any size is accepted into an empty queue).
  bool send_text(SharedBuffer payload) { return send(Opcode::text, std::move(payload)); }
  bool send_binary(SharedBuffer payload) { return send(Opcode::binary, std::move(payload)); }
  /// Bytes accepted and not yet handed to the kernel.
  size_t queued_bytes() const { return queued_.load(std::memory_order_relaxed); }
  /// Sends what is queued, then a close frame; the connection ends when the peer answers or close_wait
  /// passes.
  void close(uint16_t code, std::string_view reason = {});
  bool is_open() const { return !closing_.load(std::memory_order_relaxed); }
  /// The subprotocol of the handshake; empty when the client offered none.
  const std::string& subprotocol() const { return subprotocol_; }
  const std::string& remote() const { return remote_; }

  /// For the connection: serves until the end, starting with bytes that followed the handshake.
  boost::asio::awaitable<void> run(std::string early);
  /// For the connection: time-outs and keepalive; called a few times a second.
  void tick(Clock::time_point now);
  /// For the connection: ends without a handshake.
  void abort();

 private:
  struct Outgoing {
    FrameHead head;
    SharedBuffer payload;
    Opcode opcode;
    size_t size() const { return head.size + (payload ? payload->size() : 0); }
  };
  enum class Stage : uint8_t { open, close_sent, finishing };

  bool send(Opcode opcode, SharedBuffer payload);
  void take_inbox();
  void enqueue(Opcode opcode, SharedBuffer payload);
  void enqueue_control(Opcode opcode, std::string_view payload);
  void drop_waiting();
  void flush();
  void consume(size_t written);
  void start_close(uint16_t code, std::string_view reason);
  bool dispatch(char* data, size_t size);
  bool handle(FrameDecoder::Event event);
  boost::asio::awaitable<void> finish();
  void report(uint16_t code, std::string_view reason);

  Socket socket_;
  std::shared_ptr<WebSocketHandler> handler_;
  const WebSocketLimits limits_;
  const std::string subprotocol_, remote_;
  FrameDecoder decoder_;

  std::deque<Outgoing> wire_;  ///< network thread only
  size_t front_written_ = 0;   ///< bytes of wire_.front() already written
  size_t controls_ = 0;        ///< control frames waiting at the front of wire_
  bool waiting_ = false;       ///< for the socket to become writable
  bool batching_ = false;      ///< messages are being handled: flush after the last one
  bool drain_due_ = false;
  Stage stage_ = Stage::open;
  Clock::time_point last_read_, last_write_, ping_sent_, deadline_;
  boost::asio::basic_waitable_timer<Clock, boost::asio::wait_traits<Clock>,
                                    boost::asio::io_context::executor_type>
      flushed_;

  std::mutex inbox_mutex_;
  std::deque<Outgoing> inbox_;  ///< from other threads
  bool inbox_posted_ = false;
  std::atomic<size_t> queued_{0};
  std::atomic<bool> closing_{false};
  uint16_t end_code_ = 1006;
  std::string end_reason_;
};

}  // namespace truestep::net
