// WebSocket frames: the decoder yields the same events with the same payloads whether the bytes come at once
// or in pieces (the first byte of the input is the piece's length), and ends for good at a violation.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/net/websocket_frame.h"

namespace {

using Decoder = truestep::net::FrameDecoder;
using Events = std::vector<std::pair<Decoder::Event, std::string>>;

Events decode(std::string bytes, size_t piece) {
  Decoder decoder(1 << 12, truestep::net::Compression::deflate);
  Events events;
  for (size_t at = 0; at < bytes.size(); at += piece) {
    char* data = bytes.data() + at;
    size_t size = std::min(piece, bytes.size() - at);
    for (;;) {
      const auto event = decoder.next(data, size);
      if (event == Decoder::Event::need_more) break;
      if (event == Decoder::Event::violation) {
        events.emplace_back(event, "");
        return events;
      }
      events.emplace_back(event, decoder.payload());
    }
    if (size != 0) __builtin_trap();
  }
  return events;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const Events whole = decode(bytes, bytes.size()), pieces = decode(bytes, std::max<size_t>(1, data[0]));
  if (whole.size() != pieces.size()) __builtin_trap();
  for (size_t i = 0; i < whole.size(); ++i) {
    if (whole[i] != pieces[i]) __builtin_trap();
  }
  return 0;
}
