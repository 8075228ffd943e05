// Who may talk to this server: Host (against DNS rebinding), Origin (against foreign pages, for WebSocket
// too) and API keys. All three are checked before a body is read.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/message.h"
#include "server/net/options.h"

namespace truestep::net {

/// The keys of a file. A line is "NAME KEY", "KEY", or either with "sha256:HEX" in place of the key; '#'
/// comments. Only digests stay in memory; every key is compared in constant time.
class KeyRing {
 public:
  /// Throws Error("bad_request") when the file cannot be read or holds no key.
  static KeyRing load(const std::string& path);
  /// Name of the matching key (its digest's first 12 digits when unnamed); empty when none matches.
  std::string_view principal(std::string_view key) const;
  bool empty() const { return keys_.empty(); }

 private:
  struct Key {
    std::string name, digest;
  };
  std::vector<Key> keys_;
};

/// Decides by Host, Origin and key.
class Guard {
 public:
  explicit Guard(const Options& options);

  /// Nullopt when the request may pass; otherwise the problem to answer. Sets request.principal.
  std::optional<Response> check_source(const Request& request) const;
  /// The same for the API key; `websocket` handshakes may give it as ?access_token= because browsers cannot
  /// set headers.
  std::optional<Response> check_key(Request& request) const;

 private:
  bool host_allowed(std::string_view host) const;
  bool origin_allowed(std::string_view origin, std::string_view host) const;
  std::vector<std::string> hosts_, origins_;
  bool any_host_ = false, any_origin_ = false, any_literal_ = false;
  KeyRing keys_;
};

}  // namespace truestep::net
