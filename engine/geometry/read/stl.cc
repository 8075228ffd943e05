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
    lines_.next_filled();
    while (same_word(lines_.peek(), "solid")) {
      solid();
      if (lines_.peek().empty()) lines_.next_filled();
    }
    // What some writers leave behind the end is no part of the surface; facets are.
    if (same_word(lines_.peek(), "facet")) lines_.fail("a facet after the end of its solid");
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
  /// "endfacet", or "end facet" as some write it.
  void expect_end(std::string_view of) {
    const std::string_view w = lines_.next_word();
    if (w.empty()) lines_.fail("the file ends where end" + std::string(of) + " should be");
    if (same_word(w, "end") && same_word(lines_.peek(), of)) {
      lines_.word();
    } else if (!same_word(w, "end" + std::string(of))) {
      lines_.fail(quoted(w) + " instead of end" + std::string(of));
    }
  }
  /// Up to its end, to the next solid or to the end of the file.
  void solid() {
    expect("solid");
    // The name is the rest of the line, unless all is on one.
    while (!lines_.peek().empty() && !same_word(lines_.peek(), "facet")) lines_.word();
    if (lines_.peek().empty()) lines_.next_filled();
    while (same_word(lines_.peek(), "facet")) {
      facet();
      if (lines_.peek().empty()) lines_.next_filled();
    }
    if (lines_.peek().empty() || same_word(lines_.peek(), "solid")) return;
    expect_end("solid");
    lines_.next_filled();
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
    expect_end("loop");
    expect_end("facet");
    weld_.out.triangles.push_back(triangle);
  }

  TextLines lines_;
  Welder weld_;
};

/// "solid", then a facet or an end: what a binary file's header may begin with is not followed by these.
bool is_text(std::string_view bytes) {
  TextLines lines(bytes);
  if (!same_word(lines.next_word(), "solid")) return false;
  constexpr int kMostWords = 100;  // of a name
  for (int k = 0; k < kMostWords; ++k) {
    const std::string_view w = lines.next_word();
    if (w.empty()) return bytes.find('\0') == bytes.npos;
    if (same_word(w, "facet") || same_word(w, "endsolid") || same_word(w, "end")) return true;
  }
  return false;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kHead + kCount) return false;
  const size_t count = load_number<uint32_t>(bytes.data() + kHead, ByteOrder::little);
  const size_t length = kHead + kCount + kTriangle * count;
  return count > 0 && bytes.size() >= length && bytes.size() - length < kTriangle;
}

SurfaceFile read_stl(std::string_view bytes) {
  // Binary headers may start with "solid" too.
  return is_text(bytes) && !is_binary_stl(bytes) ? TextReader(bytes).read() : read_binary(bytes);
}

}  // namespace truestep
