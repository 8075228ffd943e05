// HTTP status lines (RFC 9110 section 15) of the codes that this service uses.
#pragma once
#include <string_view>

namespace truestep::net {

/// "HTTP/1.1 200 OK\r\n"; an unknown code gives the line of 500.
std::string_view status_line(int status);
/// "OK" for 200.
std::string_view status_reason(int status);

}  // namespace truestep::net
