// The state of one system: a value made of named, typed, unit-carrying columns. Everything that influences
// a later step lives in it, so copying, comparing, hashing and serialising a state needs to know no system.
// A column holds rows x width scalars, row after row, 64-byte aligned; columns grow independently.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/hash.h"

namespace truestep {

enum class Scalar : uint8_t { f64, f32, i32, u32, u64 };
/// `sentinel` is internal too, but NaN and infinity have a meaning there (never, unlimited, nothing yet).
enum class Role : uint8_t { position, velocity, internal, sentinel };

/// Bytes of one element.
constexpr size_t scalar_size(Scalar s) {
  return s == Scalar::f64 || s == Scalar::u64 ? 8 : 4;
}
/// "f64", "f32", "i32", "u32" or "u64".
std::string_view scalar_name(Scalar s);

template <class T>
constexpr Scalar scalar_of();
template <>
constexpr Scalar scalar_of<double>() {
  return Scalar::f64;
}
template <>
constexpr Scalar scalar_of<float>() {
  return Scalar::f32;
}
template <>
constexpr Scalar scalar_of<int32_t>() {
  return Scalar::i32;
}
template <>
constexpr Scalar scalar_of<uint32_t>() {
  return Scalar::u32;
}
template <>
constexpr Scalar scalar_of<uint64_t>() {
  return Scalar::u64;
}

struct ColumnInfo {
  std::string name;
  std::string unit;  ///< SI, "1" for a pure number
  Scalar type = Scalar::f64;
  uint32_t width = 1;
  Role role = Role::internal;
  friend bool operator==(const ColumnInfo&, const ColumnInfo&) = default;
};

class State {
 public:
  using Column = uint32_t;

  State();
  State(const State&);
  State(State&&) noexcept;
  State& operator=(const State&);
  State& operator=(State&&) noexcept;
  ~State();

  /// Adds a zero-filled column; names are unique (Error "duplicate_column" otherwise).
  Column add(ColumnInfo info, size_t rows);
  std::optional<Column> find(std::string_view name) const;
  /// Like find, but a missing column is Error "no_such_column".
  Column at(std::string_view name) const;

  size_t columns() const { return columns_.size(); }
  const ColumnInfo& info(Column c) const { return columns_[c].info; }
  size_t rows(Column c) const { return columns_[c].rows; }
  /// Keeps the first rows, fills new ones with zero.
  void resize(Column c, size_t rows);
  /// Copies row `from` over row `to`.
  void copy_row(Column c, size_t from, size_t to);
  /// Reserves memory so that growing up to `rows` does not allocate.
  void reserve(Column c, size_t rows);

  /// Takes rows and values of a column of the same type and width.
  void copy_column(Column to, const State& other, Column from) {
    columns_[to].rows = other.columns_[from].rows, columns_[to].data = other.columns_[from].data;
  }

  /// All rows x width elements. T must be the column's type (asserted).
  template <class T>
  std::span<T> span(Column c) {
    check(c, scalar_of<T>());
    return {reinterpret_cast<T*>(columns_[c].data.data()), columns_[c].rows * columns_[c].info.width};
  }
  template <class T>
  std::span<const T> span(Column c) const {
    check(c, scalar_of<T>());
    return {reinterpret_cast<const T*>(columns_[c].data.data()), columns_[c].rows * columns_[c].info.width};
  }
  std::span<double> f64(Column c) { return span<double>(c); }
  std::span<const double> f64(Column c) const { return span<double>(c); }
  std::span<const std::byte> bytes(Column c) const { return columns_[c].data; }

  /// Hash of names, shapes and contents (-0.0 counts as 0.0).
  void hash(Hasher& h) const;
  uint64_t hash() const;
  /// Same columns with the same bits.
  friend bool operator==(const State& a, const State& b);

  /// Little-endian bytes that `deserialize` turns back into an equal state.
  std::vector<std::byte> serialize() const;
  /// Error "bad_snapshot" when the bytes are not a serialised state.
  static State deserialize(std::span<const std::byte> bytes);

  size_t memory_bytes() const;

  struct BadValue {
    Column column;
    size_t row;
  };
  enum class Look : uint8_t {
    motion,
    everything
  };  ///< only positions and velocities, or internal columns
      ///< too
  /// First NaN or infinity in a floating column, or velocity beyond `speed_limit` in magnitude.
  std::optional<BadValue> first_bad(double speed_limit = std::numeric_limits<double>::infinity(),
                                    Look look = Look::motion) const;

 private:
  struct Storage {
    ColumnInfo info;
    size_t rows = 0;
    std::vector<std::byte, CacheLineAllocator<std::byte>> data;
  };
  void check(Column c, Scalar type) const;
  std::vector<Storage> columns_;
};

}  // namespace truestep
