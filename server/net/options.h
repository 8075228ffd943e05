// Everything configurable about listening, limits and time-outs, with its default.
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/net/websocket/websocket.h"

namespace truestep::net {

struct Options {
  std::string host = "127.0.0.1";      ///< literal address, or "localhost"
  uint16_t port = 8080;                ///< 0 = any free one
  int threads = 1;                     ///< network threads, one event loop each
  size_t max_connections = 10000;      ///< lowered when the process may not open this many descriptors
  size_t max_head = size_t{16} << 10;  ///< bytes of the request line and headers
  size_t max_body = size_t{16} << 20;  ///< bytes of a body; a route may override it
  std::chrono::milliseconds head_timeout{5000};  ///< from a request's first byte to its last header
  std::chrono::milliseconds body_timeout{
      10000};  ///< for the whole body, longer for a body that keeps >= 64 KiB/s
  std::chrono::milliseconds idle_timeout{60000};   ///< between requests
  std::chrono::milliseconds write_timeout{30000};  ///< without any byte taken by the peer
  WebSocketLimits websocket;
  std::vector<std::string> allowed_hosts;  ///< further names for the Host header; "*" accepts every name
  std::vector<std::string>
      allowed_origins;       ///< further origins ("https://example.org"); "*" accepts every origin
  std::string api_key_file;  ///< one key per line, see KeyRing; empty: no key is required
};

}  // namespace truestep::net
