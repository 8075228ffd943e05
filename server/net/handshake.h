// The opening handshake of a WebSocket (RFC 6455 section 4.2), without shortcuts: the key must decode to 16
// bytes, the version must be 13, and a client that offers subprotocols must offer one that the route speaks.
#pragma once
#include <optional>
#include <string>

#include "server/net/head_parser.h"
#include "server/net/inflate.h"
#include "server/net/message.h"
#include "server/net/router.h"

namespace truestep::net {

/// What was agreed.
struct Handshake {
  std::string head;         ///< the 101 response, ready for the wire
  std::string subprotocol;  ///< empty when the client offered none
  Compression compression = Compression::none;
};

/// The problem to answer, or nullopt when the handshake is good and `result` is filled.
std::optional<Response> check_handshake(const Request& request, const HeadParser& parser, const Route& route,
                                        Handshake& result);

}  // namespace truestep::net
