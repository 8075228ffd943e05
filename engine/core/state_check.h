// Looks at a state that came from outside before a system steps it: rows that belong together, rows that
// others point to, numbers that are finite. A system names the columns that grow and those that point
// (System::check); all others keep the rows that they start with.
#pragma once
#include <initializer_list>

#include "engine/core/state.h"

namespace truestep {

class StateCheck {
 public:
  using Column = State::Column;
  /// `start` is the system's initial state. Every fault is Error "bad_snapshot"; other columns than those of
  /// `start` are one at once.
  StateCheck(const State& state, const State& start);
  const State& state() const { return state_; }

  /// Columns of one number of rows, which may be any up to `most`.
  StateCheck& together(std::initializer_list<Column> columns, size_t most = SIZE_MAX);
  /// The columns from `first` to before `end`.
  StateCheck& together(Column first, Column end, size_t most = SIZE_MAX);
  /// Integers that are below `count`, or all bits of their type (-1, no row).
  StateCheck& below(Column column, uint64_t count);
  StateCheck& require(bool holds, const char* what);
  /// To be called last: columns that were not named, and every number.
  void finish() const;

 private:
  void free(Column column, size_t rows, size_t most);
  const State& state_;
  const State& start_;
  std::vector<bool> free_;
};

}  // namespace truestep
