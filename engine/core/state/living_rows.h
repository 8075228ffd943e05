// Compacts columns after rows have died: runs of living rows are moved down in one piece, so that their order
// stays.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/state/state.h"

namespace truestep {

class LivingRows {
 public:
  /// Takes the rows whose flag is zero as living. Reuses its memory from call to call.
  void set(std::span<const uint8_t> dead);
  size_t kept() const { return kept_; }
  /// Where a row ends up; empty for rows that died.
  std::optional<size_t> place(size_t row) const;
  /// Compacts a column that had one row for each flag.
  void close(State& s, State::Column c) const;

 private:
  struct Run {
    size_t begin, end, before;  ///< rows [begin, end), and the number of living rows before them
  };
  std::vector<Run> runs_;
  size_t kept_ = 0;
};

}  // namespace truestep
