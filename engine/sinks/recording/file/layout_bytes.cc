#include "engine/sinks/recording/file/layout_bytes.h"

#include <cstring>
#include <type_traits>

#include "engine/base/errors.h"

namespace truestep {
namespace {

class Out {
 public:
  template <typename T>
  void number(T value) {
    const size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }
  template <typename List>
  void list(const List& v) {
    number<uint64_t>(v.size());
    const auto all = std::as_bytes(std::span(v.data(), v.size()));
    bytes.insert(bytes.end(), all.begin(), all.end());
  }
  template <typename T, typename Each>
  void each(const std::vector<T>& v, const Each& one) {
    number<uint64_t>(v.size());
    for (const T& e : v) one(e);
  }
  std::vector<std::byte> bytes;
};

// Never reads past the end: from there on everything is empty and `good` is false.
class In {
 public:
  explicit In(std::span<const std::byte> b) : rest_(b) {}
  bool good() const { return good_; }
  bool done() const { return good_ && rest_.empty(); }

  template <typename T>
  T number() {
    T value{};
    if (take(sizeof value)) std::memcpy(&value, taken_.data(), sizeof value);
    return value;
  }
  template <typename T>
  void number(T& value) {
    value = number<T>();
  }
  template <typename List>
  void list(List& v) {
    constexpr size_t kSize = sizeof(typename List::value_type);
    const auto count = number<uint64_t>();
    if (count > rest_.size() / kSize || !take(count * kSize)) return refuse();
    v.resize(count);
    if (count > 0) std::memcpy(v.data(), taken_.data(), taken_.size());
  }
  template <typename T, typename Each>
  void each(std::vector<T>& v, const Each& one) {
    const auto count = number<uint64_t>();
    for (uint64_t i = 0; i < count && good_; ++i) one(v.emplace_back());
  }

 private:
  bool take(size_t size) {
    if (size > rest_.size()) good_ = false;
    taken_ = good_ ? rest_.first(size) : std::span<const std::byte>();
    if (good_) rest_ = rest_.subspan(size);
    return good_;
  }
  void refuse() { good_ = false; }

  std::span<const std::byte> rest_, taken_;
  bool good_ = true;
};

// One description of the format for both directions.
template <typename Stream, typename Layout>
void pass(Stream& io, Layout& layout) {
  const auto system = [&](auto& s) {
    io.list(s.id);
    io.list(s.type);
    io.number(s.max_rows);
    io.number(s.rows);
    io.each(s.fields, [&](auto& f) {
      io.list(f.name);
      io.list(f.unit);
      io.number(f.width);
      io.number(f.precision);
      io.number(f.meaning);
    });
    io.list(s.lines);
    io.list(s.triangles);
    io.number(s.kind);
    io.number(s.lattice);
    io.number(s.usual_rows);
  };
  io.each(layout.parts, system);
  io.each(layout.observables, [&](auto& o) {
    io.list(o.name);
    io.list(o.unit);
  });
  io.each(layout.drawing.parts, [&](auto& s) {
    io.list(s.instances);
    io.list(s.kinds);
    io.list(s.positions);
    io.list(s.orientations);
    io.list(s.sizes);
    io.list(s.colors);
    io.list(s.motions);
    io.list(s.groups);
    io.list(s.meshes);
    io.number(s.point_radius);
  });
  io.each(layout.drawing.meshes, [&](auto& m) {
    io.list(m.positions);
    io.list(m.triangles);
  });
  io.list(layout.scene_json);
  io.number(layout.seed);
  io.number(layout.dt);
  io.list(layout.build);
}

bool known_values(const RecordingLayout& layout) {
  for (const RecordedPart& s : layout.parts) {
    if (s.rows != RowPolicy::kFixed && s.rows != RowPolicy::kVariable) return false;
    if (s.kind > PartInfo::Kind::values || s.lattice.centring > Lattice::Centring::cells) return false;
    for (const RecordedField& f : s.fields) {
      if (f.precision != Precision::kF32 && f.precision != Precision::kF64 && f.precision != Precision::kU32)
        return false;
      if (f.meaning > Meaning::asleep) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<std::byte> layout_bytes(const RecordingLayout& layout) {
  Out out;
  pass(out, layout);
  return std::move(out.bytes);
}

std::optional<RecordingLayout> layout_from_bytes(std::span<const std::byte> bytes) {
  RecordingLayout layout;
  In in(bytes);
  pass(in, layout);
  if (!in.done() || !known_values(layout)) return std::nullopt;
  try {
    validate_layout(layout);
  } catch (const Error&) {
    return std::nullopt;
  }
  return layout;
}

}  // namespace truestep
