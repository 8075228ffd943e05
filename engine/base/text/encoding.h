// What a text file may begin with before its first word: a byte order mark (Unicode 15, 23.8). As UTF-8 it is
// skipped; UTF-16, which some Windows programs write, is converted; UTF-32 is not read.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace truestep {

/// The text after its UTF-8 byte order mark, if it has one.
std::string_view without_byte_order_mark(std::string_view text);

/// The text of a file that begins with UTF-16's mark of either byte order, as UTF-8; nothing without that
/// mark, for an odd number of bytes and for surrogates that are no pair.
std::optional<std::string> utf8_of_utf16(std::string_view bytes);

}  // namespace truestep
