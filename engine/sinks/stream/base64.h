// Base64 (RFC 4648, with padding): bytes in JSON.
#pragma once
#include <string>
#include <string_view>

namespace truestep {

void append_base64(std::string& out, std::string_view bytes);

}  // namespace truestep
