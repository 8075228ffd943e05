// Q16_DELTA: 16-bit values in a box that is kept for many frames, sent as differences to a frame the client
// holds. Both ends use the same integers, so a decoded value is within half a quantum of the true one after
// any number of differences: errors do not add up, and any frame of the same box can be a base. A key frame
// (the values themselves, as Q16) goes to a client that holds none of this box. The box is renewed when a
// value leaves it, and every kBoxFrames frames so that it can shrink. One coder serves all clients that asked
// for the same fields. A frame is encoded once per base in use: clients that keep up share one, one that
// skipped frames has its own, and only bases that some client holds stay in memory.
#pragma once
#include <memory>
#include <vector>

#include "engine/sinks/stream/frame_encoding.h"
#include "engine/sinks/stream/quantise.h"

namespace truestep {

/// The integers of one frame that were sent to a client, and their boxes (one per Q16_DELTA field).
struct QuantisedFrame {
  std::shared_ptr<const std::vector<QuantumBox>> boxes;
  std::vector<std::vector<uint16_t>> values;
};
using QuantisedFramePtr = std::shared_ptr<const QuantisedFrame>;

/// Bytes of repeated Block, for every client that holds the same base.
struct EncodedBlocks {
  std::shared_ptr<const std::string> bytes;
  QuantisedFramePtr held;  ///< what a client can take as its next base; null: nothing
  enum class Kind : uint8_t { key, refers_to_base } kind = Kind::key;
};

class DeltaCoder {
 public:
  static constexpr uint64_t kBoxFrames = 240;

  explicit DeltaCoder(std::vector<WireField> fields) : fields_(std::move(fields)) {}
  const std::vector<WireField>& fields() const { return fields_; }

  /// The frame for a client that holds `base` (null: nothing). Frames may come in any order.
  EncodedBlocks encode(const FramePtr& frame, const QuantisedFramePtr& base);

 private:
  void quantise_frame(const FramePtr& frame);
  bool renew_boxes(const Frame& frame, bool keep_seen);
  bool fill(const Frame& frame, QuantisedFrame& into) const;

  std::vector<WireField> fields_;
  FramePtr frame_;
  QuantisedFramePtr now_;           ///< of frame_; null: a value is not finite
  std::vector<ColumnBounds> seen_;  ///< bounds that the boxes were made for
  std::shared_ptr<const std::vector<QuantumBox>> boxes_;
  uint64_t frames_in_box_ = 0;
  std::vector<std::pair<QuantisedFramePtr, EncodedBlocks>> encodings_;  ///< of frame_, by base
};

}  // namespace truestep
