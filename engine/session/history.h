// Snapshots of past steps within a bound in bytes. When the bound is reached every other snapshot goes and
// the interval doubles, so the whole past stays reachable at a cost that grows with its length.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/session/world.h"

namespace truestep {

class History {
 public:
  explicit History(size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Keeps a copy when this step is a multiple of the interval and newer than the newest kept.
  void offer(const WorldState& state);
  /// Newest snapshot at or before `step`, or null.
  const WorldState* at_or_before(uint64_t step) const;
  /// Forgets snapshots after `step`.
  void truncate(uint64_t step);
  void clear();
  std::vector<uint64_t> steps() const;
  size_t memory_bytes() const { return bytes_; }

 private:
  static constexpr uint64_t kFirstInterval = 64;
  size_t max_bytes_;
  size_t bytes_ = 0;
  uint64_t interval_ = kFirstInterval;
  std::vector<WorldState> snapshots_;
};

}  // namespace truestep
