// Frames with given values and the bytes of a stream's messages, for tests of the stream's encodings.
#pragma once
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "engine/sinks/stream/delta_coder.h"
#include "tests/support/stream_decoder.h"

namespace truestep {

/// Field `number` of the only system, sent as floats of this width.
inline WireField stream_field(uint32_t number, uint32_t width, WireEncoding encoding) {
  return {{0, number, Scalar::f32}, encoding, "a", "field" + std::to_string(number), "", width};
}

/// A frame that holds values[k] for fields[k].
inline FramePtr stream_frame(const std::vector<WireField>& fields,
                             const std::vector<std::vector<float>>& values) {
  auto frame = std::make_shared<Frame>();
  for (size_t k = 0; k < fields.size(); ++k) {
    FrameBlock& b = frame->blocks.emplace_back();
    b.key = fields[k].key;
    b.width = fields[k].width;
    b.rows = values[k].size() / b.width;
    b.data.resize(4 * values[k].size());
    if (!values[k].empty()) std::memcpy(b.data.data(), values[k].data(), b.data.size());
  }
  return frame;
}

/// A client of a DeltaCoder: keeps the last frame received, as in the server's record of it.
struct DeltaClient {
  QuantisedFramePtr base;
  uint64_t seq = 0;
  StreamDecoder decoder;
  v1::Frame message;  ///< as received last

  std::vector<std::vector<double>> receive(DeltaCoder& coder, const FramePtr& frame) {
    const EncodedBlocks blocks = coder.encode(frame, base);
    const uint64_t base_seq = blocks.kind == EncodedBlocks::Kind::refers_to_base ? seq : 0;
    base = blocks.held;
    if (!message.ParseFromString(encode_frame_fields(*frame, {++seq, 0, base_seq}) + *blocks.bytes))
      throw std::runtime_error("no Frame message");
    return decoder.decode(message);
  }
};

}  // namespace truestep
