#include "engine/core/state/state.h"

#include <cmath>
#include <cstring>

#include "engine/base/errors.h"

namespace truestep {

State::State() = default;
State::State(const State&) = default;
State::State(State&&) noexcept = default;
State& State::operator=(const State&) = default;
State& State::operator=(State&&) noexcept = default;
State::~State() = default;

std::string_view scalar_name(Scalar s) {
  constexpr std::string_view kNames[] = {"f64", "f32", "i32", "u32", "u64"};
  return kNames[static_cast<size_t>(s)];
}

State::Column State::add(ColumnInfo info, size_t rows) {
  if (find(info.name)) throw Error("duplicate_column", "two columns are named " + info.name);
  columns_.push_back({std::move(info), 0, {}});
  const auto c = static_cast<Column>(columns_.size() - 1);
  resize(c, rows);
  return c;
}

std::optional<State::Column> State::find(std::string_view name) const {
  for (Column c = 0; c < columns_.size(); ++c) {
    if (columns_[c].info.name == name) return c;
  }
  return std::nullopt;
}

State::Column State::at(std::string_view name) const {
  if (const auto c = find(name)) return *c;
  throw Error("no_such_column", "no column is named " + std::string(name));
}

void State::resize(Column c, size_t rows) {
  Storage& s = columns_[c];
  s.rows = rows;
  s.data.resize(rows * s.info.width * scalar_size(s.info.type));
}

void State::copy_row(Column c, size_t from, size_t to) {
  Storage& s = columns_[c];
  const size_t bytes = s.info.width * scalar_size(s.info.type);
  if (from != to) std::memcpy(s.data.data() + to * bytes, s.data.data() + from * bytes, bytes);
}

void State::reserve(Column c, size_t rows) {
  Storage& s = columns_[c];
  s.data.reserve(rows * s.info.width * scalar_size(s.info.type));
}

void State::check(Column c, Scalar type) const {
  if (columns_[c].info.type != type) {
    throw Error("wrong_column_type", "column " + columns_[c].info.name + " is " +
                                         std::string(scalar_name(columns_[c].info.type)) + ", not " +
                                         std::string(scalar_name(type)));
  }
}

void State::hash(Hasher& h) const {
  h.integer(columns_.size());
  for (Column c = 0; c < columns_.size(); ++c) {
    const Storage& s = columns_[c];
    h.text(s.info.name);
    h.integer(static_cast<uint64_t>(s.info.type) | uint64_t{s.info.width} << 8);
    h.integer(s.rows);
    if (s.info.type == Scalar::f64) {
      h.doubles(span<double>(c));
    } else if (s.info.type == Scalar::f32) {
      h.floats(span<float>(c));
    } else {
      h.bytes(s.data.data(), s.data.size());
    }
  }
}

uint64_t State::hash() const {
  Hasher h;
  hash(h);
  return h.value();
}

bool operator==(const State& a, const State& b) {
  if (a.columns_.size() != b.columns_.size()) return false;
  for (size_t c = 0; c < a.columns_.size(); ++c) {
    const auto &p = a.columns_[c], &q = b.columns_[c];
    if (p.info != q.info || p.rows != q.rows || p.data.size() != q.data.size()) return false;
    if (!p.data.empty() && std::memcmp(p.data.data(), q.data.data(), p.data.size()) != 0) return false;
  }
  return true;
}

namespace {
constexpr uint32_t kMagic = 0x31535354;  // "TSS1"

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  void raw(const void* p, size_t n) {
    const auto* b = static_cast<const std::byte*>(p);
    out_.insert(out_.end(), b, b + n);
  }
  template <class T>
  void put(T v) {
    raw(&v, sizeof v);
  }
  void text(const std::string& s) {
    put(static_cast<uint32_t>(s.size()));
    raw(s.data(), s.size());
  }

 private:
  std::vector<std::byte>& out_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> in) : in_(in) {}
  std::span<const std::byte> raw(size_t n) {
    if (n > in_.size()) throw Error("bad_snapshot", "the snapshot ends too early");
    const auto part = in_.first(n);
    in_ = in_.subspan(n);
    return part;
  }
  template <class T>
  T get() {
    T v;
    std::memcpy(&v, raw(sizeof v).data(), sizeof v);
    return v;
  }
  std::string text() {
    const auto part = raw(get<uint32_t>());
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  bool done() const { return in_.empty(); }

 private:
  std::span<const std::byte> in_;
};
}  // namespace

std::vector<std::byte> State::serialize() const {
  std::vector<std::byte> out;
  out.reserve(memory_bytes() + 64 * columns_.size() + 16);
  Writer w(out);
  w.put(kMagic);
  w.put(static_cast<uint32_t>(columns_.size()));
  for (const Storage& s : columns_) {
    w.text(s.info.name);
    w.text(s.info.unit);
    w.put(static_cast<uint8_t>(s.info.type));
    w.put(static_cast<uint8_t>(s.info.role));
    w.put(s.info.width);
    w.put(static_cast<uint64_t>(s.rows));
    w.raw(s.data.data(), s.data.size());
  }
  return out;
}

State State::deserialize(std::span<const std::byte> bytes) {
  Reader r(bytes);
  if (r.get<uint32_t>() != kMagic) throw Error("bad_snapshot", "these bytes are not a serialised state");
  State state;
  const auto count = r.get<uint32_t>();
  // More than any system has; columns are distinguished one by one.
  constexpr uint32_t kMostColumns = 1024;
  if (count > kMostColumns) throw Error("bad_snapshot", "the snapshot has too many columns");
  for (uint32_t i = 0; i < count; ++i) {
    ColumnInfo info;
    info.name = r.text();
    info.unit = r.text();
    const auto type = r.get<uint8_t>(), role = r.get<uint8_t>();
    info.width = r.get<uint32_t>();
    const auto rows = r.get<uint64_t>();
    if (type > 4 || role > 3 || info.width > 4096 || rows > (uint64_t{1} << 40) || state.find(info.name)) {
      throw Error("bad_snapshot", "a column of the snapshot is malformed");
    }
    info.type = static_cast<Scalar>(type);
    info.role = static_cast<Role>(role);
    const auto data = r.raw(rows * info.width * scalar_size(info.type));
    const Column c = state.add(std::move(info), rows);
    if (!data.empty()) std::memcpy(state.columns_[c].data.data(), data.data(), data.size());
  }
  if (!r.done()) throw Error("bad_snapshot", "bytes follow the end of the snapshot");
  return state;
}

size_t State::memory_bytes() const {
  size_t n = 0;
  for (const Storage& s : columns_) n += s.data.capacity();
  return n;
}

namespace {

// Sums of term(v) in many lanes, so that the additions do not wait for each other.
template <class T, class Term>
T lane_sum(std::span<const T> values, Term term) {
  constexpr size_t kLanes = 32;
  T sum[kLanes] = {};
  size_t i = 0;
  for (; i + kLanes <= values.size(); i += kLanes) {
    for (size_t k = 0; k < kLanes; ++k) sum[k] += term(values[i + k]);
  }
  for (; i < values.size(); ++i) sum[0] += term(values[i]);
  T total = 0;
  for (const T lane : sum) total += lane;
  return total;
}

// Index of the first value that is not finite or beyond the limit. One sweep answers for nearly every column:
// v * 0 is NaN exactly when v is NaN or infinite, and no velocity is beyond the limit when the sum of all
// squares is not.
template <class T>
std::optional<size_t> first_beyond(std::span<const T> values, double limit) {
  const bool limited = limit < std::numeric_limits<double>::infinity();
  if (limited ? lane_sum(values, [](T v) { return v * v; }) <= limit * limit
              : lane_sum(values, [](T v) { return v * T(0); }) == 0) {
    return std::nullopt;
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || (limited && std::abs(values[i]) > limit)) return i;
  }
  return std::nullopt;
}

}  // namespace

std::optional<State::BadValue> State::first_bad(double speed_limit, Look look) const {
  for (Column c = 0; c < columns_.size(); ++c) {
    const ColumnInfo& info = columns_[c].info;
    if (info.role == Role::sentinel || (info.role == Role::internal && look == Look::motion)) continue;
    const double limit = info.role == Role::velocity ? speed_limit : std::numeric_limits<double>::infinity();
    const auto bad = info.type == Scalar::f64   ? first_beyond(span<double>(c), limit)
                     : info.type == Scalar::f32 ? first_beyond(span<float>(c), limit)
                                                : std::nullopt;
    if (bad) return BadValue{c, *bad / info.width};
  }
  return std::nullopt;
}

}  // namespace truestep
