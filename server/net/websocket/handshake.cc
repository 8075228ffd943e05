#include "server/net/websocket/handshake.h"

#include <boost/beast/http/rfc7230.hpp>

#include "server/net/http/problem.h"

namespace truestep::net {

bool is_websocket_key(std::string_view key) {
  constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  // 16 bytes are 21 characters and 2 bits of another, whose other 4 bits are zero.
  return key.size() == 24 && key.substr(0, 22).find_first_not_of(kBase64) == std::string_view::npos &&
         kBase64.find(key[21]) % 16 == 0 && key.ends_with("==");
}

bool is_deflate_offer_safe(std::string_view extensions) {
  for (const auto& [name, parameters] : boost::beast::http::ext_list(extensions)) {
    for (const auto& [key, value] : parameters) {
      if (iequals(key, "server_max_window_bits") && value == "8") return false;
    }
  }
  return true;
}

std::optional<Response> check_handshake(const Request& request, const Route& route,
                                        std::string& subprotocol) {
  if (!request.header_has_token("upgrade", "websocket") ||
      !request.header_has_token("connection", "upgrade") || request.http10 ||
      request.header("sec-websocket-version") != "13") {
    return problem(request, "upgrade_required", "this is a WebSocket: ask for an upgrade to version 13");
  }
  size_t keys = 0;
  for (const Field& f : request.headers) keys += iequals(f.name, "sec-websocket-key");
  if (keys != 1 || !is_websocket_key(request.header("sec-websocket-key"))) {
    return problem(request, "bad_request", "Sec-WebSocket-Key must hold 16 bytes in base64, once");
  }
  subprotocol.clear();
  if (request.header("sec-websocket-protocol").empty()) return std::nullopt;
  Issue issue;
  for (const std::string& supported : route.subprotocols) {
    if (request.header_has_token("sec-websocket-protocol", supported)) {
      subprotocol = supported;
      return std::nullopt;
    }
    issue.allowed += (issue.allowed.empty() ? "" : ", ") + supported;
  }
  issue.code = "unknown_subprotocol";
  issue.message = "none of the offered subprotocols is supported";
  return problem(request, "bad_request", "supported subprotocols: " + issue.allowed, {&issue, 1});
}

}  // namespace truestep::net
