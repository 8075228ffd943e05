// HTTP requests: Beast's parser with our own refusals gives the same result whether the bytes come at once or
// one by one, never consumes more than it was given, and refuses with a client error status. Bodies are read
// too.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "server/net/http/request_parser.h"

namespace {

using truestep::net::Request;
using truestep::net::RequestParser;
using Progress = RequestParser::Progress;

struct Outcome {
  Progress progress;
  size_t used;
};

// Feeds the available bytes after each piece, and again after the head.
Outcome feed(RequestParser& parser, std::string_view text, size_t piece) {
  size_t used = 0;
  for (size_t end = std::min(piece, text.size()); end <= text.size(); end += piece) {
    for (bool again = true; again;) {
      used += parser.feed(text.substr(used, end - used));
      if (used > end) __builtin_trap();
      again = parser.progress() == Progress::head && parser.has_body();
      if (again) parser.set_body_limit(1000);
      if (parser.status() != 0) return {Progress::refused, used};
    }
    if (parser.progress() != Progress::need_more || end == text.size()) break;
    end = std::min(end, text.size() - piece);
  }
  return {parser.progress(), used};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Request from_whole, from_pieces;
  RequestParser whole(from_whole, 4096), pieces(from_pieces, 4096);
  const Outcome at_once = feed(whole, text, std::max<size_t>(size, 1)), by_byte = feed(pieces, text, 1);
  // Byte by byte, Beast waits for the end of a head or chunk header and finds its errors later.
  if (at_once.progress != by_byte.progress && at_once.progress != Progress::refused) __builtin_trap();
  if (at_once.progress == Progress::refused && by_byte.progress != Progress::refused &&
      by_byte.progress != Progress::need_more)
    __builtin_trap();
  if (at_once.progress == Progress::refused && (whole.status() < 400 || whole.status() > 599))
    __builtin_trap();
  if (at_once.progress != Progress::head && at_once.progress != Progress::complete) return 0;
  if (at_once.used != by_byte.used || from_whole.target != from_pieces.target ||
      from_whole.headers.size() != from_pieces.headers.size() || from_whole.body != from_pieces.body)
    __builtin_trap();
  for (const auto& f : from_whole.headers) {
    if (f.value.find_first_of("\r\n") != std::string_view::npos) __builtin_trap();
  }
  return 0;
}
