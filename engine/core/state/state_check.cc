#include "engine/core/state/state_check.h"

#include "engine/base/errors.h"

namespace truestep {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error("bad_snapshot", "no run of this scene leads to this state: " + what);
}

template <class T>
bool all_below(std::span<const T> values, uint64_t count) {
  constexpr T kNone = static_cast<T>(-1);
  for (const T v : values) {
    if (v != kNone && (v < T{0} || static_cast<uint64_t>(v) >= count)) return false;
  }
  return true;
}

}  // namespace

StateCheck::StateCheck(const State& state, const State& start)
    : state_(state), start_(start), free_(start.columns()) {
  bool same = state.columns() == start.columns();
  for (Column c = 0; same && c < start.columns(); ++c) same = state.info(c) == start.info(c);
  if (!same) throw Error("bad_snapshot", "the snapshot belongs to another scene");
}

void StateCheck::free(Column column, size_t rows, size_t most) {
  free_[column] = true;
  if (state_.rows(column) != rows || rows > most)
    refuse(state_.info(column).name + " has " + std::to_string(state_.rows(column)) + " rows");
}

StateCheck& StateCheck::together(std::initializer_list<Column> columns, size_t most) {
  for (const Column c : columns) free(c, state_.rows(*columns.begin()), most);
  return *this;
}

StateCheck& StateCheck::together(Column first, Column end, size_t most) {
  for (Column c = first; c < end; ++c) free(c, state_.rows(first), most);
  return *this;
}

StateCheck& StateCheck::below(Column column, uint64_t count) {
  const Scalar type = state_.info(column).type;
  const bool good = type == Scalar::u32   ? all_below(state_.span<uint32_t>(column), count)
                    : type == Scalar::i32 ? all_below(state_.span<int32_t>(column), count)
                                          : all_below(state_.span<uint64_t>(column), count);
  return require(good, state_.info(column).name.c_str());
}

StateCheck& StateCheck::require(bool holds, const char* what) {
  if (!holds) refuse(what);
  return *this;
}

void StateCheck::finish() const {
  for (Column c = 0; c < start_.columns(); ++c) {
    if (!free_[c] && state_.rows(c) != start_.rows(c))
      refuse(state_.info(c).name + " has " + std::to_string(state_.rows(c)) + " rows");
  }
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  if (const auto bad = state_.first_bad(kNoLimit, State::Look::everything))
    refuse(state_.info(bad->column).name + " of row " + std::to_string(bad->row) + " is not finite");
}

}  // namespace truestep
