// One WebSocket: what a session's stream holds to send, and what it implements to receive. Outgoing messages
// are shared buffers in a queue bounded in bytes; what to do when the queue is long (drop, skip, close) is up
// to the owner, which reads queued_bytes() and is told when the queue has run empty. Pings and pongs are
// answered here and overtake waiting messages. Any thread may send and close; the handler is called on the
// network thread only.
#pragma once
#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "server/net/http/message.h"

namespace truestep::net {

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
  std::chrono::seconds stall{30};          ///< nothing could be written for this long: cut
  std::chrono::seconds ping_interval{20};  ///< after silence; twice this without any byte: cut
  std::chrono::seconds close_wait{3};      ///< for the peer's close frame and the last bytes
};

/// The two parts of a message, sent one after the other; the second may be null.
using MessageParts = std::array<SharedBuffer, 2>;

class WebSocket {
 public:
  virtual ~WebSocket() = default;
  /// Queues one message. Returns false and queues nothing when the socket is closing or the queue would
  /// exceed its limit (an empty queue accepts a message of any size).
  virtual bool send(MessageKind kind, MessageParts parts) = 0;
  bool send_text(SharedBuffer payload) { return send(MessageKind::text, {std::move(payload), nullptr}); }
  bool send_binary(SharedBuffer payload) { return send(MessageKind::binary, {std::move(payload), nullptr}); }
  /// Bytes accepted and not yet handed to the kernel.
  virtual size_t queued_bytes() const = 0;
  /// Sends what is queued, then a close frame; the connection ends when the peer answers or close_wait
  /// passes.
  virtual void close(uint16_t code, std::string_view reason = {}) = 0;
  virtual bool is_open() const = 0;
  /// The subprotocol of the handshake; empty when the client offered none.
  virtual const std::string& subprotocol() const = 0;
  virtual const std::string& remote() const = 0;
};

}  // namespace truestep::net
