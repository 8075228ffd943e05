// Snapshots of past steps within a bound in bytes. When the bound is reached every other snapshot goes and
// the interval doubles, so the whole past stays reachable at a cost that grows with its length.
// Snapshots are as frequent as half a percent of the run's time allows, so that going back costs at most some
// two hundred times the copying of one state, however dear a step is. When they are taken changes no bit of
// the states. The memory of one that goes is copied into by the next: after the first thinning a snapshot
// allocates nothing.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/session/world.h"

namespace truestep {

class History {
 public:
  /// Told of the bytes that all snapshots shall take before they are allocated, and when fewer are left:
  /// false when there is no room for as many. Empty: there always is.
  using Room = std::function<bool(size_t bytes)>;
  explicit History(size_t max_bytes, Room room = {}) : max_bytes_(max_bytes), room_(std::move(room)) {}

  /// Whether a snapshot is wanted at the end of this step: then the step is timed.
  bool due(uint64_t step) const { return step % std::max(cadence_, spacing_) == 0; }
  /// Copies a due state that is newer than the newest kept, unless its step, which took `step_seconds`, was
  /// too cheap for a snapshot so soon.
  void offer(const WorldState& state, double step_seconds);
  /// Copies a state that is newer than the newest kept, whatever its step has taken.
  void keep(const WorldState& state);
  /// Newest snapshot at or before `step`, or null.
  const WorldState* at_or_before(uint64_t step) const;
  /// Forgets snapshots after `step`.
  void truncate(uint64_t step);
  /// Forgets snapshots before `step`.
  void forget_before(uint64_t step);
  /// Forgets all and gives their memory back.
  void clear();
  std::vector<uint64_t> steps() const;
  std::vector<const WorldState*> snapshots() const;
  /// Of the snapshots and of the memory kept for the next ones; at most the bound.
  size_t memory_bytes() const { return bytes_; }

 private:
  static constexpr uint64_t kLeastCadence = 16, kMostCadence = 1024;
  void set_cadence(size_t bytes, double step_seconds);
  void thin_out();
  bool fits(size_t bytes) const { return bytes <= max_bytes_ && (!room_ || room_(bytes)); }

  size_t max_bytes_;
  Room room_;
  size_t bytes_ = 0;                  ///< of `snapshots_` and `spare_`
  uint64_t cadence_ = kLeastCadence;  ///< steps between snapshots that the time allows
  uint64_t spacing_ = kLeastCadence;  ///< ... and that the bound in bytes allows; both powers of two
  double step_seconds_ = 0;
  std::vector<WorldState> snapshots_;  ///< by step
  std::vector<WorldState> spare_;      ///< their contents mean nothing
};

}  // namespace truestep
