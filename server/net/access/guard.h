// Who may talk to this server: Host (against DNS rebinding), Origin (against foreign pages, for WebSocket
// too) and API keys. All three are checked before a body is read.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/access/key_throttle.h"
#include "server/net/access/keys.h"
#include "server/net/http/message.h"
#include "server/net/options.h"

namespace truestep::net {

/// Decides by Host, Origin and key.
class Guard {
 public:
  explicit Guard(const Options& options);

  /// Nullopt when the request may pass; otherwise the problem to answer.
  std::optional<Response> check_source(const Request& request) const;
  /// The same for the API key; sets request.caller. WebSocket handshakes may pass it as ?access_token=
  /// because browsers cannot set headers. 429 for an address that keeps guessing.
  std::optional<Response> check_key(Request& request);
  KeyFile& keys() { return keys_; }

 private:
  bool host_allowed(std::string_view host) const;
  bool origin_allowed(std::string_view origin, std::string_view host) const;
  std::vector<std::string> hosts_, origins_;
  bool any_host_ = false, any_origin_ = false, any_literal_ = false;
  KeyFile keys_;
  KeyThrottle throttle_;
};

}  // namespace truestep::net
