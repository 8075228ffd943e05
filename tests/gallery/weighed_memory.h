// How much memory a process has taken for something, beside what was estimated for it: what the allocator has
// handed out, or the kernel's peak when that is more.
#pragma once
#include <cstddef>

namespace truestep::testing {

/// Estimated over true memory.
inline constexpr double kLeastRatio = 0.7, kMostRatio = 1.5;

/// As in the service: memory that a growing large vector releases is returned at once. Call it before
/// anything is allocated.
void return_large_blocks();

/// Weighs what this process has taken since the object was made. Memory left over by something else would be
/// reused: a process weighs one thing.
class WeighedMemory {
 public:
  explicit WeighedMemory(double estimated_bytes);
  /// After `steps` steps; looks only at powers of two and at the last of kSteps, and no more once the memory
  /// rests.
  void after_step(size_t steps);
  /// Looks now. Whether it is the same as at the last look, well within the bounds.
  bool look();
  double bytes() const;
  double estimated() const { return estimated_; }
  double ratio() const { return estimated_ / bytes(); }
  bool within() const { return ratio() >= kLeastRatio && ratio() <= kMostRatio; }
  /// Steps after which a look is the last one.
  static constexpr size_t kFewest = 32, kSteps = 120;

 private:
  double estimated_, held_before_, peak_before_;
  double held_ = 0, grown_ = 0;
  bool rests_ = false;
};

/// Whether an estimate is wrong: beyond the ratios, and by more than the 64 KiB a system that a handful of
/// rows or a short formula cannot be told apart from.
bool memory_is_off(double estimated_bytes, double bytes, double systems);

}  // namespace truestep::testing
