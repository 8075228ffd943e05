// Frames kept for clients that poll, bounded in bytes. Without pollers no frame is built or kept: the first
// poll switches the sink on, and half a minute without one switches it off.
#pragma once
#include <chrono>
#include <deque>
#include <vector>

#include "engine/session/world/frame.h"

namespace truestep {

class PollSink : public Sink {
 public:
  explicit PollSink(FrameRequest request, size_t max_bytes = size_t{16} << 20)
      : request_(std::move(request)), max_bytes_(max_bytes) {
    touch();
  }

  bool due(uint64_t) override { return !expired(); }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr& frame) override;
  void notify(std::string_view kind, uint64_t step, const std::string& detail) override;

  /// Kept frames after step `after`, oldest first, at most `limit`.
  std::vector<FramePtr> after(uint64_t after, size_t limit) const;
  /// Frames dropped because of the bound.
  uint64_t dropped() const { return dropped_; }
  size_t memory_bytes() const { return bytes_; }
  void touch() { last_poll_ = std::chrono::steady_clock::now(); }
  bool expired() const { return std::chrono::steady_clock::now() - last_poll_ > std::chrono::seconds(30); }

 private:
  FrameRequest request_;
  size_t max_bytes_, bytes_ = 0;
  uint64_t dropped_ = 0;
  std::deque<FramePtr> frames_;
  std::chrono::steady_clock::time_point last_poll_;
};

}  // namespace truestep
