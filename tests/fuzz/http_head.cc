// HTTP request heads: the parser says the same whether the bytes come at once or one by one, never consumes
// more than it was given, and refuses with a client's status.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "server/net/head_parser.h"

using truestep::net::HeadParser;
using truestep::net::Request;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  HeadParser whole(4096), pieces(4096);
  Request from_whole, from_pieces;
  const auto at_once = whole.parse(text, from_whole);
  auto by_byte = HeadParser::Result::need_more;
  for (size_t n = 1; n <= size && by_byte == HeadParser::Result::need_more; ++n) {
    by_byte = pieces.parse(text.substr(0, n), from_pieces);
  }
  if (size > 0 && at_once != by_byte) __builtin_trap();
  if (at_once == HeadParser::Result::done) {
    if (whole.consumed() > size || whole.consumed() != pieces.consumed()) __builtin_trap();
    if (from_whole.target != from_pieces.target || from_whole.headers.size() != from_pieces.headers.size() ||
        whole.framing() != pieces.framing() || whole.content_length() != pieces.content_length()) {
      __builtin_trap();
    }
  }
  if (at_once == HeadParser::Result::error && (whole.status() < 400 || whole.status() > 599))
    __builtin_trap();
  return 0;
}
