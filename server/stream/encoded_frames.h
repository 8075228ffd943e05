// The encodings of the newest frame, shared by all clients of a session that asked for the same fields and,
// where blocks are differences, hold the same earlier frame.
#pragma once
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "engine/sinks/stream/delta_coder.h"
#include "engine/sinks/stream/frame_encoding.h"

namespace truestep {

class EncodedFrames {
 public:
  /// The blocks for a client that holds `base` (null: nothing).
  EncodedBlocks get(const FramePtr& frame, const std::vector<WireField>& fields,
                    const QuantisedFramePtr& base) {
    if (std::any_of(fields.begin(), fields.end(),
                    [](const WireField& f) { return f.encoding == WireEncoding::q16_delta; }))
      return coder(fields).encode(frame, base);
    if (frame.get() != frame_.get()) {
      frame_ = frame;
      encodings_.clear();
    }
    for (const auto& [key, bytes] : encodings_) {
      if (key == fields) return {bytes, nullptr};
    }
    encodings_.emplace_back(fields, encode_blocks(*frame, fields));
    return {encodings_.back().second, nullptr};
  }
  /// Approximate memory use: a coder keeps the frames that its clients have.
  size_t memory_bytes() const {
    size_t n = 0;
    for (const auto& [fields, bytes] : encodings_) n += bytes->size();
    if (frame_) n += (1 + coders_.size()) * frame_->memory_bytes();
    return n;
  }
  /// Frees the frames; clients get key frames next.
  void clear() {
    frame_.reset();
    encodings_.clear();
    coders_.clear();
  }

 private:
  static constexpr size_t kCoders = 8;

  // The coder for these fields, moved to the end; the least recently used one makes room for a new one.
  DeltaCoder& coder(const std::vector<WireField>& fields) {
    auto found = std::find_if(coders_.begin(), coders_.end(),
                              [&](const DeltaCoder& c) { return c.fields() == fields; });
    if (found == coders_.end()) {
      if (coders_.size() == kCoders) coders_.erase(coders_.begin());
      coders_.emplace_back(fields);
    } else {
      std::rotate(found, found + 1, coders_.end());
    }
    return coders_.back();
  }

  FramePtr frame_;
  std::vector<std::pair<std::vector<WireField>, std::shared_ptr<const std::string>>> encodings_;
  std::vector<DeltaCoder> coders_;
};

}  // namespace truestep
