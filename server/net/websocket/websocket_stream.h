// The connection's side of a WebSocket. Boost.Beast speaks the protocol (RFC 6455, permessage-deflate for
// what is received); this file adds the queue, the time-outs, and what Beast lacks: close codes above 4999
// are refused, text that ends inside a character with an empty last fragment is refused, and a connection is
// not reset while its close frame is on the way.
#pragma once
#include <memory>
#include <string>

#include "server/net/socket.h"
#include "server/net/websocket/websocket.h"
#include "server/tasks/task.h"

namespace truestep::net {

/// A WebSocket that a connection serves. All on the network thread.
class ServedWebSocket : public WebSocket {
 public:
  /// Answers the handshake and serves until the end.
  virtual Task<> run() = 0;
  /// Checks deadlines and sends pings; called a few times a second.
  virtual void tick(Clock::time_point now) = 0;
  /// Ends without a handshake.
  virtual void abort() = 0;
};

/// Serves the handshake in `request`, which check_handshake has accepted.
std::shared_ptr<ServedWebSocket> make_websocket(Socket socket, const Request& request,
                                                std::shared_ptr<WebSocketHandler> handler,
                                                WebSocketLimits limits, std::string subprotocol);

}  // namespace truestep::net
