// The strict JSON reader (RFC 8259 and I-JSON, RFC 7493) for every document from outside. Stricter than most:
// duplicate keys (also when one is escaped), numbers beyond the range of a double, lone surrogates, a byte
// order mark, invalid UTF-8 and nesting beyond a limit are refused. Numbers are rounded correctly
// (std::from_chars); integers that fit stay int64 or uint64. Time and memory are linear in the size of the
// text. boost::json::parse does none of the first three and rounds the last digit wrongly.
#pragma once
#include <boost/json/value.hpp>
#include <cstddef>
#include <string>
#include <string_view>

namespace truestep {

/// Upper limits for a document.
struct JsonLimits {
  size_t max_bytes = size_t{64} << 20;  ///< bytes of text
  int max_depth = 32;                   ///< nested arrays and objects
  size_t max_values = 20'000'000;  ///< of all kinds; each takes about 24 bytes, and twice that while it grows
};

/// Parses one document. Throws Error("bad_json") with one Issue that names the JSON pointer and the byte
/// offset, or Error("too_large") when the text is longer or more deeply nested than the limits.
boost::json::value parse_json(std::string_view text, const JsonLimits& limits = {});

/// Appends one reference token to a JSON pointer, escaped as RFC 6901 asks ("~" -> "~0", "/" -> "~1").
void append_pointer(std::string& pointer, std::string_view token);

}  // namespace truestep
