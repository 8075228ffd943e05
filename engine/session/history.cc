#include "engine/session/history.h"

namespace truestep {

void History::offer(const WorldState& state) {
  if (state.step % interval_ != 0) return;
  if (!snapshots_.empty() && snapshots_.back().step >= state.step) return;
  const size_t size = state.memory_bytes();
  if (size > max_bytes_) return;
  while (bytes_ + size > max_bytes_) {
    // Thin out: only multiples of the doubled interval stay.
    interval_ *= 2;
    std::erase_if(snapshots_, [&](const WorldState& s) { return s.step % interval_ != 0; });
    bytes_ = 0;
    for (const WorldState& s : snapshots_) bytes_ += s.memory_bytes();
    if (state.step % interval_ != 0) return;
  }
  snapshots_.push_back(state);
  bytes_ += size;
}

const WorldState* History::at_or_before(uint64_t step) const {
  for (size_t i = snapshots_.size(); i-- > 0;) {
    if (snapshots_[i].step <= step) return &snapshots_[i];
  }
  return nullptr;
}

void History::truncate(uint64_t step) {
  while (!snapshots_.empty() && snapshots_.back().step > step) {
    bytes_ -= snapshots_.back().memory_bytes();
    snapshots_.pop_back();
  }
}

void History::clear() {
  snapshots_.clear();
  bytes_ = 0;
  interval_ = kFirstInterval;
}

std::vector<uint64_t> History::steps() const {
  std::vector<uint64_t> out;
  for (const WorldState& s : snapshots_) out.push_back(s.step);
  return out;
}

}  // namespace truestep
