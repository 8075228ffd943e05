#include "server/net/handshake.h"

#include <algorithm>

#include "server/net/digest.h"
#include "server/net/problem.h"

namespace truestep::net {

std::optional<Response> check_handshake(const Request& request, const HeadParser& parser, const Route& route,
                                        Handshake& result) {
  if (parser.framing() != Framing::none) return problem(request, "bad_request", "a handshake has no body");
  if (!parser.upgrade_websocket() || request.header("sec-websocket-version") != "13") {
    return problem(request, "upgrade_required", "this is a WebSocket: ask for an upgrade to version 13");
  }
  size_t keys = 0;
  std::string_view key;
  std::vector<std::string_view> offered;
  for (const Field& f : request.headers) {
    if (iequals(f.name, "sec-websocket-key")) {
      ++keys;
      key = f.value;
    } else if (iequals(f.name, "sec-websocket-protocol")) {
      for (std::string_view rest = f.value; !rest.empty();) {
        const size_t comma = std::min(rest.find(','), rest.size());
        offered.push_back(trim(rest.substr(0, comma)));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
      }
    }
  }
  const auto decoded = base64_decode(key);
  if (keys != 1 || !decoded || decoded->size() != 16) {
    return problem(request, "bad_request", "Sec-WebSocket-Key must hold 16 bytes in base64, once");
  }
  for (const std::string& supported : route.subprotocols) {
    if (std::find(offered.begin(), offered.end(), supported) == offered.end()) continue;
    result.subprotocol = supported;
    break;
  }
  if (!offered.empty() && result.subprotocol.empty()) {
    Issue issue;
    issue.code = "unknown_subprotocol";
    for (const std::string& supported : route.subprotocols)
      issue.allowed += (issue.allowed.empty() ? "" : ", ") + supported;
    issue.message = "none of the offered subprotocols is spoken here";
    return problem(request, "bad_request", "supported subprotocols: " + issue.allowed, {&issue, 1});
  }
  const auto accept = sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");
  result.head =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: "
      "Upgrade\r\nSec-WebSocket-Accept: ";
  result.head += base64_encode(accept.data(), accept.size());
  if (!result.subprotocol.empty()) result.head += "\r\nSec-WebSocket-Protocol: " + result.subprotocol;
  if (const auto extension = negotiate_deflate(request)) {
    result.compression = Compression::deflate;
    result.head += "\r\nSec-WebSocket-Extensions: " + *extension;
  }
  result.head += "\r\n\r\n";
  return std::nullopt;
}

}  // namespace truestep::net
