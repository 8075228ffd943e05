#include "server/sessions/poll_sink.h"

namespace truestep {

void PollSink::accept(const FramePtr& frame) {
  frames_.push_back(frame);
  bytes_ += frame->memory_bytes();
  while (bytes_ > max_bytes_ && frames_.size() > 1) {
    bytes_ -= frames_.front()->memory_bytes();
    frames_.pop_front();
    ++dropped_;
  }
}

void PollSink::notify(std::string_view kind, uint64_t, const std::string&) {
  if (kind == "reset" || kind == "seek") {
    frames_.clear();
    bytes_ = 0;
  }
}

std::vector<FramePtr> PollSink::after(uint64_t after, size_t limit) const {
  std::vector<FramePtr> out;
  for (const FramePtr& f : frames_) {
    if (f->step > after && out.size() < limit) out.push_back(f);
  }
  return out;
}

}  // namespace truestep
