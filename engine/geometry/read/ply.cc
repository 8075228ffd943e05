#include "engine/geometry/read/ply.h"

#include <cmath>

#include "engine/geometry/read/byte_order.h"
#include "engine/geometry/read/ply_header.h"

namespace truestep {

namespace {

constexpr double kMostPlyCorners = 10'000;  // of a face

/// Values one after another, as text.
class TextValues {
 public:
  explicit TextValues(TextLines& lines) : lines_(lines) {}
  double next(PlyType, const std::string& what) {
    const std::string_view w = lines_.next_word();
    double out = 0;
    if (w.empty()) lines_.fail("the file ends where " + what + " should be");
    if (!read_double(w, out)) lines_.fail(quoted(w) + " instead of " + what);
    return out;
  }
  void skip(PlyType type, double count, const std::string& what) {
    for (double k = 0; k < count; ++k) next(type, what);
  }
  [[noreturn]] void fail(const std::string& message) const { lines_.fail(message); }

 private:
  TextLines& lines_;
};

/// The same from bytes.
class BinaryValues {
 public:
  BinaryValues(std::string_view whole, size_t from, ByteOrder order)
      : bytes_(whole), at_(from), order_(order) {}
  double next(PlyType type, const std::string& what) {
    last_ = at_;
    if (bytes_.size() - at_ < size_of(type)) fail("the file ends where " + what + " should be");
    const char* p = bytes_.data() + at_;
    at_ += size_of(type);
    switch (type) {
      case PlyType::i8:
        return load_number<int8_t>(p, order_);
      case PlyType::u8:
        return load_number<uint8_t>(p, order_);
      case PlyType::i16:
        return load_number<int16_t>(p, order_);
      case PlyType::u16:
        return load_number<uint16_t>(p, order_);
      case PlyType::i32:
        return load_number<int32_t>(p, order_);
      case PlyType::u32:
        return load_number<uint32_t>(p, order_);
      case PlyType::f32:
        return load_number<float>(p, order_);
      case PlyType::f64:
        break;
    }
    return load_number<double>(p, order_);
  }
  void skip(PlyType type, double count, const std::string& what) {
    last_ = at_;
    // Counts have 32 bits: no overflow.
    const size_t length = size_of(type) * static_cast<size_t>(count);
    if (bytes_.size() - at_ < length) fail("the file ends in " + what);
    at_ += length;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw MeshFault(MeshFault::Unit::byte, last_ + 1, message);
  }

 private:
  std::string_view bytes_;
  size_t at_, last_ = 0;
  ByteOrder order_;
};

template <class Values>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Values values) : header_(header), values_(std::move(values)) {}

  SurfaceFile read() {
    for (const PlyElement& e : header_.elements) {
      for (size_t k = 0; k < e.count; ++k) {
        if (e.name == "vertex") {
          vertex(e, k);
        } else {
          other(e, k);
        }
      }
    }
    // Faces may come before vertices.
    for (const auto& t : out_.triangles) {
      for (const uint32_t p : t) {
        if (p < out_.vertices.size()) continue;
        values_.fail("a face has vertex " + std::to_string(p) + ", and the file has " +
                     std::to_string(out_.vertices.size()));
      }
    }
    if (out_.vertices.empty()) values_.fail("the file has no vertices");
    return std::move(out_);
  }

 private:
  double length(const PlyProperty& p, const std::string& what) {
    const double n = values_.next(*p.count, "the length of " + what);
    if (!(n >= 0 && n <= 4294967295.0) || n != std::floor(n))
      values_.fail("the length of " + what + " must be a whole number");
    return n;
  }
  void vertex(const PlyElement& e, size_t which) {
    Vec3 p{NAN, NAN, NAN};
    for (const PlyProperty& property : e.properties) {
      const std::string& name = property.name;
      if (property.count) {
        values_.skip(property.type, length(property, name), name);
        continue;
      }
      const double value = values_.next(property.type, name);
      if (name == "x") p.x = value;
      if (name == "y") p.y = value;
      if (name == "z") p.z = value;
    }
    if (!(std::abs(p.x) <= kMostFileCoordinate && std::abs(p.y) <= kMostFileCoordinate &&
          std::abs(p.z) <= kMostFileCoordinate)) {
      values_.fail("vertex " + std::to_string(which) + " has no x, y and z of at most 1e12");
    }
    out_.vertices.push_back(p);
  }
  void other(const PlyElement& e, size_t which) {
    for (const PlyProperty& property : e.properties) {
      const std::string& name = property.name;
      if (!property.count) {
        values_.skip(property.type, 1, name);
        continue;
      }
      const double n = length(property, name);
      if (e.name == "face" && (name == "vertex_indices" || name == "vertex_index")) {
        face(property.type, n, which);
      } else {
        values_.skip(property.type, n, name);
      }
    }
  }
  void face(PlyType type, double corners, size_t which) {
    const std::string what = "a corner of face " + std::to_string(which);
    if (corners < 3 || corners > kMostPlyCorners) {
      values_.fail("face " + std::to_string(which) + " has " + std::to_string(static_cast<int64_t>(corners)) +
                   " corners: it must have 3 to 10000");
    }
    std::array<uint32_t, 3> t{};
    for (size_t k = 0; k < static_cast<size_t>(corners); ++k) {
      const double p = values_.next(type, what);
      if (!(p >= 0 && p < static_cast<double>(kMostFileVertices)) || p != std::floor(p))
        values_.fail(what + " is not the index of a vertex");
      if (k < 3) {
        t[k] = static_cast<uint32_t>(p);
      } else {
        t = {t[0], t[2], static_cast<uint32_t>(p)};
      }
      if (k < 2) continue;
      if (out_.triangles.size() == kMostFileTriangles)
        values_.fail("more than " + std::to_string(kMostFileTriangles) + " triangles");
      out_.triangles.push_back(t);
    }
  }

  const PlyHeader& header_;
  Values values_;
  SurfaceFile out_;
};

}  // namespace

SurfaceFile read_ply(std::string_view bytes) {
  TextLines lines(bytes);
  const PlyHeader header = read_ply_header(lines);
  if (header.format == PlyFormat::ascii) return PlyReader(header, TextValues(lines)).read();
  const ByteOrder order =
      header.format == PlyFormat::binary_little_endian ? ByteOrder::little : ByteOrder::big;
  return PlyReader(header, BinaryValues(bytes, bytes.size() - lines.text_after().size(), order)).read();
}

}  // namespace truestep
