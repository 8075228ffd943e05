// Closing over rows that end: runs of living rows between them are moved down in one piece, so that the
// order of the others stays.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/state.h"

namespace truestep {

class LivingRows {
 public:
  /// Takes the rows whose flag is zero. Keeps its memory from call to call.
  void set(std::span<const uint8_t> dead);
  size_t kept() const { return kept_; }
  /// Where a row is after closing; nothing for those that ended.
  std::optional<size_t> place(size_t row) const;
  /// Keeps these rows of a column that had one for each flag.
  void close(State& s, State::Column c) const;

 private:
  struct Run {
    size_t begin, end, before;  ///< rows [begin, end); how many live before them
  };
  std::vector<Run> runs_;
  size_t kept_ = 0;
};

}  // namespace truestep
