// Serialises status line and headers of a response into a buffer that is reused from request to request.
#pragma once
#include <string>

#include "server/net/http/message.h"

namespace truestep::net {

/// What the connection decides about a response.
enum class ConnectionFate : unsigned char { keep, close, keep_http10 };

/// Appends the complete head, blank line included. Writes Date, Content-Type, Content-Length, ETag, the
/// headers of the response and Connection. 204 and 304 carry no Content-Length; a StreamBody is chunked, or
/// ends with the connection if that is to close.
void append_head(std::string& out, const Response& response, uint64_t content_length, ConnectionFate fate);

/// "Sat, 21 Nov 2026 04:00:00 GMT" (RFC 9110 section 5.6.7).
std::string http_date(std::time_t time);

}  // namespace truestep::net
