// Session ids.
#pragma once
#include <string>
#include <string_view>

namespace truestep {

/// A random session id (UUID version 4).
std::string random_session_id();
/// Whether a client may choose this as a session id: a UUID in lower-case hexadecimal digits.
bool is_session_id(std::string_view text);

}  // namespace truestep
