#include "engine/geometry/read/stl.h"

#include <cmath>
#include <map>

#include "engine/geometry/read/byte_order.h"
#include "engine/geometry/read/text_lines.h"

namespace truestep {

namespace {

constexpr size_t kHead = 80, kCount = 4, kTriangle = 50, kNormal = 12;

/// Merges corners at the same position into one vertex, numbered in order of appearance.
class Welder {
 public:
  uint32_t vertex(Vec3 p) {
    // Zero has two signs but is one position.
    p = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
    const auto [at, fresh] =
        known_.emplace(std::array{p.x, p.y, p.z}, static_cast<uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back(p);
    return at->second;
  }
  SurfaceFile out;

 private:
  std::map<std::array<double, 3>, uint32_t> known_;
};

SurfaceFile read_binary(std::string_view bytes) {
  const auto fail = [](size_t at, const std::string& message) {
    throw MeshFault(MeshFault::Unit::byte, at + 1, message);
  };
  if (bytes.size() < kHead + kCount) {
    fail(bytes.size(), "an STL file either begins with \"solid\" or has 84 bytes before its triangles");
  }
  const auto count = load_number<uint32_t>(bytes.data() + kHead, ByteOrder::little);
  if (count == 0) fail(kHead, "the file has no triangles");
  if (count > kMostFileTriangles) {
    fail(kHead, "the file announces " + std::to_string(count) + " triangles: at most " +
                    std::to_string(kMostFileTriangles) + " are read");
  }
  if (bytes.size() < kHead + kCount + kTriangle * count) {
    fail(bytes.size(), "the file ends in triangle " +
                           std::to_string((bytes.size() - kHead - kCount) / kTriangle) + " of " +
                           std::to_string(count));
  }
  Welder weld;
  for (size_t t = 0; t < count; ++t) {
    std::array<uint32_t, 3> triangle{};
    for (size_t k = 0; k < 3; ++k) {
      const size_t at = kHead + kCount + kTriangle * t + kNormal + 12 * k;
      double p[3];
      for (size_t c = 0; c < 3; ++c) {
        p[c] = load_number<float>(bytes.data() + at + 4 * c, ByteOrder::little);
        if (!(std::abs(p[c]) <= kMostFileCoordinate)) {
          fail(at + 4 * c,
               "a coordinate of triangle " + std::to_string(t) + " is not a number of at most 1e12");
        }
      }
      triangle[k] = weld.vertex({p[0], p[1], p[2]});
    }
    weld.out.triangles.push_back(triangle);
  }
  return std::move(weld.out);
}

class TextReader {
 public:
  explicit TextReader(std::string_view text) : lines_(text) {}

  SurfaceFile read() {
    while (lines_.next_filled()) solid();
    if (weld_.out.triangles.empty()) lines_.fail("the file ends without a facet");
    return std::move(weld_.out);
  }

 private:
  void expect(std::string_view word) {
    const std::string_view w = lines_.next_word();
    if (w.empty()) lines_.fail("the file ends where " + std::string(word) + " should be");
    if (!same_word(w, word)) lines_.fail(quoted(w) + " instead of " + std::string(word));
  }
  double number() {
    if (lines_.peek().empty() && !lines_.next_filled())
      lines_.fail("the file ends where a coordinate should be");
    return lines_.coordinate("a coordinate");
  }
  void solid() {
    expect("solid");
    if (!lines_.next_filled()) lines_.fail("the file ends without endsolid");
    while (same_word(lines_.peek(), "facet")) {
      facet();
      if (lines_.peek().empty() && !lines_.next_filled()) lines_.fail("the file ends without endsolid");
    }
    expect("endsolid");
  }
  void facet() {
    expect("facet");
    expect("normal");
    // Not a coordinate: writers put nan for triangles without area.
    for (size_t c = 0; c < 3; ++c) {
      if (lines_.next_word().empty()) lines_.fail("the file ends in a normal");
    }
    expect("outer");
    expect("loop");
    if (weld_.out.triangles.size() == kMostFileTriangles) {
      lines_.fail("more than " + std::to_string(kMostFileTriangles) + " triangles");
    }
    std::array<uint32_t, 3> triangle{};
    for (uint32_t& corner : triangle) {
      expect("vertex");
      const double x = number(), y = number(), z = number();
      corner = weld_.vertex({x, y, z});
    }
    expect("endloop");
    expect("endfacet");
    weld_.out.triangles.push_back(triangle);
  }

  TextLines lines_;
  Welder weld_;
};

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kHead + kCount) return false;
  const size_t count = load_number<uint32_t>(bytes.data() + kHead, ByteOrder::little);
  return bytes.size() == kHead + kCount + kTriangle * count;
}

SurfaceFile read_stl(std::string_view bytes) {
  // Binary headers may start with "solid" too: the length decides.
  if (is_binary_stl(bytes)) return read_binary(bytes);
  if (same_word(TextLines(bytes).next_word(), "solid")) return TextReader(bytes).read();
  return read_binary(bytes);
}

}  // namespace truestep
