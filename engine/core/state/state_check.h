// Checks a state from outside before a system steps it: rows that belong together, indices of rows, finite
// numbers. A system names the columns that grow and those that hold indices (System::check); all others keep
// their initial number of rows.
#pragma once
#include <initializer_list>

#include "engine/core/state/state.h"

namespace truestep {

class StateCheck {
 public:
  using Column = State::Column;
  /// `start` is the system's initial state. Every fault is Error "bad_snapshot"; columns other than those of
  /// `start` are refused at once.
  StateCheck(const State& state, const State& start);
  const State& state() const { return state_; }

  /// Columns with the same number of rows, up to `most`.
  StateCheck& together(std::initializer_list<Column> columns, size_t most = SIZE_MAX);
  /// The columns from `first` up to but excluding `end`.
  StateCheck& together(Column first, Column end, size_t most = SIZE_MAX);
  /// Integers below `count`, or all bits set (-1: no row).
  StateCheck& below(Column column, uint64_t count);
  StateCheck& require(bool holds, const char* what);
  /// Call last: checks the columns not named, and every number.
  void finish() const;

 private:
  void free(Column column, size_t rows, size_t most);
  const State& state_;
  const State& start_;
  std::vector<bool> free_;
};

}  // namespace truestep
