// Snapshots of past steps, bounded in bytes. When the bound is reached every other snapshot is dropped and
// the interval doubles, so the whole past stays reachable at a cost that grows with its length.
// Snapshots are as frequent as half a percent of the run's time allows, so that going back costs at most
// about two hundred times the copying of one state, however expensive a step is. When they are taken does not
// affect the states' bits. The memory of dropped snapshots is reused: after the first thinning a snapshot
// allocates nothing.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/session/world/world.h"

namespace truestep {

class History {
 public:
  /// Called with the bytes that all snapshots will take, before they are allocated and when fewer are left;
  /// returns false when there is no room. Empty: there always is.
  using Room = std::function<bool(size_t bytes)>;
  explicit History(size_t max_bytes, Room room = {}) : max_bytes_(max_bytes), room_(std::move(room)) {}

  /// Whether a snapshot is wanted at the end of this step, which is then timed.
  bool due(uint64_t step) const { return step % std::max(cadence_, spacing_) == 0; }
  /// Copies a due state newer than the newest kept, unless its step, which took `step_seconds`, was too cheap
  /// for another snapshot so soon.
  void offer(const WorldState& state, double step_seconds);
  /// Copies a state newer than the newest kept, however long its step took.
  void keep(const WorldState& state);
  /// Newest snapshot at or before `step`, or null.
  const WorldState* at_or_before(uint64_t step) const;
  /// Forgets snapshots after `step`.
  void truncate(uint64_t step);
  /// Forgets snapshots before `step`.
  void forget_before(uint64_t step);
  /// Forgets everything and frees the memory.
  void clear();
  std::vector<uint64_t> steps() const;
  std::vector<const WorldState*> snapshots() const;
  /// Of the snapshots and the spare memory for the next ones; at most the bound.
  size_t memory_bytes() const { return bytes_; }

 private:
  static constexpr uint64_t kLeastCadence = 16, kMostCadence = 1024;
  void set_cadence(size_t bytes, double step_seconds);
  void thin_out();
  bool fits(size_t bytes) const { return bytes <= max_bytes_ && (!room_ || room_(bytes)); }

  size_t max_bytes_;
  Room room_;
  size_t bytes_ = 0;                  ///< of `snapshots_` and `spare_`
  uint64_t cadence_ = kLeastCadence;  ///< steps between snapshots allowed by time
  uint64_t spacing_ = kLeastCadence;  ///< ... and by the bound in bytes; both powers of two
  double step_seconds_ = 0;
  std::vector<WorldState> snapshots_;  ///< by step
  std::vector<WorldState> spare_;      ///< reusable memory; contents meaningless
};

}  // namespace truestep
