#include "engine/geometry/read/ply.h"

#include <cmath>
#include <span>

#include "engine/geometry/read/byte_order.h"
#include "engine/geometry/read/ply_header.h"
#include "engine/geometry/read/polygon.h"

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
  size_t place() const { return lines_.line(); }
  [[noreturn]] void fail_at(size_t place, const std::string& message) const {
    throw MeshFault(MeshFault::Unit::line, place, message);
  }

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
  [[noreturn]] void fail(const std::string& message) const { fail_at(place(), message); }
  size_t place() const { return last_ + 1; }
  [[noreturn]] void fail_at(size_t place, const std::string& message) const {
    throw MeshFault(MeshFault::Unit::byte, place, message);
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
    if (out_.vertices.empty()) values_.fail("the file has no vertices");
    cut_faces();
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
      const bool indices = name == "vertex_indices" || name == "vertex_index";
      if (e.name == "face" && indices) {
        face(property.type, n, which);
      } else if (e.name == "tristrips" && indices) {
        strips(property.type, n);
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
    faces_.push_back({corners_.size(), values_.place()});
    for (size_t k = 0; k < static_cast<size_t>(corners); ++k)
      corners_.push_back(static_cast<uint32_t>(index(type, 0, what)));
    count_triangles(static_cast<size_t>(corners) - 2);
  }
  double index(PlyType type, double least, const std::string& what) {
    const double p = values_.next(type, what);
    if (!(p >= least && p < static_cast<double>(kMostFileVertices)) || p != std::floor(p))
      values_.fail(what + " is not the index of a vertex");
    return p;
  }
  void count_triangles(size_t more) {
    triangles_ += more;
    if (triangles_ > kMostFileTriangles)
      values_.fail("more than " + std::to_string(kMostFileTriangles) + " triangles");
  }
  void strips(PlyType type, double length) {
    std::array<uint32_t, 2> last{};
    size_t along = 0;
    for (double k = 0; k < length; ++k) {
      const double p = index(type, -1, "a corner of a strip");
      if (p < 0) {
        along = 0;
        continue;
      }
      const auto corner = static_cast<uint32_t>(p);
      if (along >= 2) {
        count_triangles(1);
        faces_.push_back({corners_.size(), values_.place()});
        // Every second triangle of a strip runs backwards.
        const bool odd = along % 2 == 1;
        for (const uint32_t c : {last[odd ? 1 : 0], last[odd ? 0 : 1], corner}) corners_.push_back(c);
      }
      last = {last[1], corner}, ++along;
    }
  }
  /// Faces may come before vertices.
  void cut_faces() {
    PolygonCutter cutter;
    out_.triangles.reserve(triangles_);
    for (size_t f = 0; f < faces_.size(); ++f) {
      const auto [first, place] = faces_[f];
      const size_t end = f + 1 < faces_.size() ? faces_[f + 1].first : corners_.size();
      const std::span<const uint32_t> face(&corners_[first], end - first);
      for (const uint32_t p : face) {
        if (p < out_.vertices.size()) continue;
        values_.fail_at(place, "a face has vertex " + std::to_string(p) + ", and the file has " +
                                   std::to_string(out_.vertices.size()));
      }
      const std::string why = cutter.cut(out_.vertices, face, out_.triangles);
      if (!why.empty()) values_.fail_at(place, why);
    }
  }

  struct Face {
    size_t first, place;  ///< of its corners; of the file
  };
  const PlyHeader& header_;
  Values values_;
  SurfaceFile out_;
  std::vector<Face> faces_;
  std::vector<uint32_t> corners_;
  size_t triangles_ = 0;
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
