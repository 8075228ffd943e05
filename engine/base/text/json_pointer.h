// Keys inside JSON pointers (RFC 6901): "~" and "/" are written "~0" and "~1".
#pragma once
#include <string>
#include <string_view>

namespace truestep {

/// A key as a token of a pointer.
inline std::string pointer_token(std::string_view key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

}  // namespace truestep
