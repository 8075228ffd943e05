// What Beast leaves unchecked in the opening handshake of a WebSocket (RFC 6455 section 4.2): the key must be
// 16 bytes in base64, data must not precede the answer, a client that offers subprotocols must offer one that
// the route speaks, and an offer of permessage-deflate that Beast answers wrongly is ignored.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "server/net/http/message.h"
#include "server/net/http/router.h"

namespace truestep::net {

/// Whether this is the base64 form of exactly 16 bytes.
bool is_websocket_key(std::string_view key);
/// Whether Beast may answer these extension offers. It answers server_max_window_bits=8 with 9, which is more
/// than the client allows.
bool is_deflate_offer_safe(std::string_view extensions);

/// The problem to answer, or nullopt when the handshake is good; `subprotocol` is then the one agreed on,
/// empty when the client offered none.
std::optional<Response> check_handshake(const Request& request, const Route& route, std::string& subprotocol);

}  // namespace truestep::net
