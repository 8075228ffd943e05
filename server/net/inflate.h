// Received messages compressed with permessage-deflate (RFC 7692), without context takeover. Only receiving:
// what is sent goes to many clients from one shared buffer, and loopback and local networks outrun deflate.
#pragma once
#include <boost/beast/zlib/inflate_stream.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/net/message.h"

namespace truestep::net {

enum class Compression : uint8_t { none, deflate };
enum class InflateResult : uint8_t { good, bad, too_large };

/// Decompresses whole messages; holds 32 KiB of window once the first one has come.
class Inflater {
 public:
  /// Replaces `out` by the decompressed message, unless that would be longer than `limit`.
  InflateResult run(std::string_view compressed, size_t limit, std::string& out);

 private:
  boost::beast::zlib::inflate_stream stream_;
};

/// The value of Sec-WebSocket-Extensions to answer to the request's offers; nullopt when there is none that
/// is well-formed and can be served.
std::optional<std::string> negotiate_deflate(const Request& request);

}  // namespace truestep::net
