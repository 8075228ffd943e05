// The opening handshake of a WebSocket.
#include "server/net/websocket/beast_websocket.h"
#include "server/net/websocket/handshake.h"

namespace truestep::net {

namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

namespace {

http::request<http::empty_body> handshake_of(const Request& r) {
  http::request<http::empty_body> out(http::verb::get, r.target, 11);
  for (const Field& f : r.headers) {
    if (!iequals(f.name, "sec-websocket-extensions") || is_deflate_offer_safe(f.value))
      out.insert(f.name, f.value);
  }
  return out;
}

}  // namespace

BeastWebSocket::BeastWebSocket(Socket socket, const Request& request,
                               std::shared_ptr<WebSocketHandler> handler, WebSocketLimits limits,
                               std::string subprotocol)
    : ws_(std::move(socket), limits.close_wait),
      handshake_(handshake_of(request)),
      handler_(std::move(handler)),
      limits_(limits),
      subprotocol_(std::move(subprotocol)),
      remote_(request.remote) {}

// Written at once: run() has waited until there is room for it. The coroutine of async_accept would be a
// third of all templates.
boost::system::error_code BeastWebSocket::accept() {
  ws_.auto_fragment(false);
  ws_.read_message_max(limits_.max_message);
  // For receiving only: outgoing messages go to many clients from one shared buffer, and loopback and local
  // networks outrun deflate.
  websocket::permessage_deflate deflate;
  deflate.server_enable = true;
  deflate.server_no_context_takeover = deflate.client_no_context_takeover = true;
  ws_.set_option(deflate);
  ws_.compress(false);
  ws_.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
    response.set(http::field::server, "truestep");
    if (!subprotocol_.empty()) response.set(http::field::sec_websocket_protocol, subprotocol_);
  }));
  // Beast considers codes above 4999 valid and would echo them; a close already begun takes precedence.
  ws_.control_callback([this](websocket::frame_type kind, boost::beast::string_view) {
    if (kind != websocket::frame_type::close || ws_.reason().code <= 4999 || closing_.exchange(true)) return;
    end_code_ = 1002;
    end_reason_ = "the close code is not allowed";
    send_close();
  });
  boost::system::error_code ec;
  ws_.accept(handshake_, ec);
  handshake_ = {};
  return ec;
}

std::shared_ptr<ServedWebSocket> make_websocket(Socket socket, const Request& request,
                                                std::shared_ptr<WebSocketHandler> handler,
                                                WebSocketLimits limits, std::string subprotocol) {
  return std::make_shared<BeastWebSocket>(std::move(socket), request, std::move(handler), limits,
                                          std::move(subprotocol));
}

}  // namespace truestep::net
