// The encodings of the newest frame, shared by all clients of a session that asked for the same.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "engine/sinks/stream/frame_encoding.h"

namespace truestep {

class EncodedFrames {
 public:
  std::shared_ptr<const std::string> get(const FramePtr& frame, const std::vector<WireField>& fields) {
    if (frame.get() != frame_.get()) {
      frame_ = frame;
      encodings_.clear();
    }
    for (const auto& [key, bytes] : encodings_) {
      if (key == fields) return bytes;
    }
    encodings_.emplace_back(fields, encode_blocks(*frame, fields));
    return encodings_.back().second;
  }
  /// Lets go of the frame's memory.
  void clear() {
    frame_.reset();
    encodings_.clear();
  }

 private:
  FramePtr frame_;
  std::vector<std::pair<std::vector<WireField>, std::shared_ptr<const std::string>>> encodings_;
};

}  // namespace truestep
