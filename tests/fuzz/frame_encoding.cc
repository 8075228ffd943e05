// Q16_DELTA and QUAT32 over arbitrary floats: what a client decodes is within half a quantum (or the stated
// angle) of what was sent, in every frame, whichever frames the client missed. The first byte holds the row's
// width and whether frames are missed; then frames of up to 64 floats follow, each preceded by its number of
// rows.
#include <cmath>
#include <cstdint>
#include <cstring>

#include "engine/sinks/stream/quaternion_packing.h"
#include "tests/support/stream_frames.h"

using namespace truestep;

namespace {

void need(bool true_here) {
  if (!true_here) __builtin_trap();
}

void check(const v1::Block& block, const std::vector<double>& decoded, const std::vector<float>& sent) {
  need(decoded.size() == sent.size());
  for (size_t i = 0; i < sent.size(); ++i) {
    if (block.encoding() == v1::F32) {
      need(decoded[i] == sent[i] || (std::isnan(decoded[i]) && std::isnan(sent[i])));
    } else if (block.encoding() != v1::QUAT32) {
      const double scale = block.scale(static_cast<int>(i % block.width()));
      need(std::abs(decoded[i] - sent[i]) <= scale * (0.5 + 1e-7));
    }
  }
  if (block.encoding() != v1::QUAT32) return;
  for (size_t i = 0; i < sent.size(); i += 4) {
    double norm = 0, dot = 0;
    for (size_t c = i; c < i + 4; ++c) norm += double(sent[c]) * sent[c], dot += decoded[c] * sent[c];
    // Cosine of half the angle; 1e-6 for decoded quaternions, whose length is only approximately 1.
    need(std::abs(dot) / std::sqrt(norm) > std::cos(kQuaternionPackingError / 2) - 1e-6);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const uint32_t width = 1 + data[0] % 5;
  const bool misses = data[0] & 0x80;
  DeltaCoder coder(
      {stream_field(0, width, WireEncoding::q16_delta), stream_field(1, 4, WireEncoding::quat32)});
  DeltaClient client;
  size_t at = 1;
  for (int n = 0; at < size; ++n) {
    const size_t rows = data[at++] % 40;
    std::vector<float> x(rows * width), q(rows * 4);
    for (std::vector<float>* v : {&x, &q}) {
      const size_t bytes = std::min(size - at, 4 * v->size());
      if (bytes > 0) std::memcpy(v->data(), data + at, bytes);
      at += bytes;
    }
    const FramePtr frame = stream_frame(coder.fields(), {x, q});
    if (misses && n % 3 == 1) {
      coder.encode(frame, nullptr);  // for some other client
      continue;
    }
    const auto decoded = client.receive(coder, frame);
    check(client.message.blocks(0), decoded[0], x);
    check(client.message.blocks(1), decoded[1], q);
  }
  return 0;
}
