#include "engine/geometry/read/obj.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "engine/geometry/read/polygon.h"
#include "engine/geometry/read/text_lines.h"

namespace truestep {

namespace {

constexpr size_t kMostCorners = 10'000;  // of a face
constexpr std::string_view kPassedOver[] = {"vt",        "vn",  "vp",    "g",        "o",        "s",
                                            "mg",        "l",   "p",     "usemtl",   "mtllib",   "usemap",
                                            "maplib",    "lod", "bevel", "c_interp", "d_interp", "shadow_obj",
                                            "trace_obj", "t",   "ctech", "stech"};
constexpr std::string_view kFreeForm[] = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf", "parm",
                                          "trim",   "hole", "scrv", "sp",   "end",  "con",   "call", "csh"};

bool among(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : lines_(text) {}

  SurfaceFile read() {
    while (lines_.next_filled()) {
      const std::string_view key = lines_.word();
      if (key.starts_with('#')) continue;
      if (key == "v") {
        vertex();
      } else if (key == "f" || key == "fo") {
        face();
      } else if (among(key, kFreeForm)) {
        lines_.fail("free-form curves and surfaces (" + quoted(key) + ") are not read, only v and f");
      } else if (!among(key, kPassedOver)) {
        lines_.fail(quoted(key) + " is not a statement of an OBJ file");
      } else {
        // A statement continued after a backslash: its next lines are not statements.
        while (lines_.rest().ends_with('\\') && lines_.next()) continue;
      }
    }
    if (out_.vertices.empty()) lines_.fail("the file ends without a vertex (v x y z)");
    cut_faces();
    return std::move(out_);
  }

 private:
  struct Face {
    size_t first, line;  ///< of its corners; where it stands
  };
  [[noreturn]] static void fail_at(size_t line, const std::string& message) {
    throw MeshFault(MeshFault::Unit::line, line, message);
  }
  /// The next word of the statement, on its next line after a backslash, which may touch the word before it.
  std::string_view word() {
    for (;;) {
      std::string_view w = continued_ ? std::string_view("\\") : lines_.peek();
      continued_ = false;
      if (w == "\\") {
        if (!lines_.next()) return {};
        continue;
      }
      if (w.starts_with('#')) return {};
      lines_.word();
      if (w.ends_with('\\') && lines_.peek().empty()) w.remove_suffix(1), continued_ = true;
      return w;
    }
  }
  double coordinate() {
    const std::string_view w = word();
    double out = 0;
    if (w.empty()) lines_.fail("a coordinate is missing");
    if (!read_double(w, out)) lines_.fail(quoted(w) + " instead of a coordinate");
    if (!(std::abs(out) <= kMostFileCoordinate))
      lines_.fail(quoted(w) + " is not a coordinate: use a number of at most 1e12");
    return out;
  }
  void vertex() {
    if (out_.vertices.size() == kMostFileVertices) {
      lines_.fail("more than " + std::to_string(kMostFileVertices) + " vertices");
    }
    const double x = coordinate(), y = coordinate(), z = coordinate();
    out_.vertices.push_back({x, y, z});
    double more = 0;
    // A weight, or the three components of a colour.
    for (std::string_view w = word(); !w.empty(); w = word()) {
      if (!read_double(w, more)) lines_.fail(quoted(w) + " after the coordinates of a vertex");
    }
  }
  /// From 0; negative: not before the beginning.
  int64_t corner(std::string_view w) {
    const std::string_view head = w.substr(0, w.find('/'));
    int64_t index = 0;
    const auto [end, error] = std::from_chars(head.data(), head.data() + head.size(), index);
    if (error != std::errc() || end != head.data() + head.size())
      lines_.fail(quoted(w) + " is not a corner of a face: use an index, or index/texture/normal");
    const auto count = static_cast<int64_t>(out_.vertices.size());
    if (index == 0 || index < -count) {
      lines_.fail("a face has vertex " + std::to_string(index) + ", and " + std::to_string(count) +
                  (count == 1 ? " vertex comes" : " vertices come") + " before it");
    }
    if (index > static_cast<int64_t>(kMostFileVertices)) missing(index, lines_.line());
    return index < 0 ? count + index : index - 1;
  }
  [[noreturn]] void missing(int64_t index, size_t line) const {
    fail_at(line, "a face has vertex " + std::to_string(index) + ", and the file has " +
                      std::to_string(out_.vertices.size()));
  }
  void face() {
    const size_t first = corners_.size();
    faces_.push_back({first, lines_.line()});
    for (std::string_view w = word(); !w.empty(); w = word()) {
      if (corners_.size() - first == kMostCorners)
        lines_.fail("a face has more than " + std::to_string(kMostCorners) + " corners");
      corners_.push_back(static_cast<uint32_t>(corner(w)));
    }
    const size_t count = corners_.size() - first;
    if (count < 3) lines_.fail("a face has " + std::to_string(count) + " corners: it needs at least three");
    triangles_ += count - 2;
    if (triangles_ > kMostFileTriangles) {
      lines_.fail("more than " + std::to_string(kMostFileTriangles) + " triangles");
    }
  }
  void cut_faces() {
    PolygonCutter cutter;
    out_.triangles.reserve(triangles_);
    for (size_t f = 0; f < faces_.size(); ++f) {
      const size_t end = f + 1 < faces_.size() ? faces_[f + 1].first : corners_.size();
      const std::span<const uint32_t> face(&corners_[faces_[f].first], end - faces_[f].first);
      for (const uint32_t p : face) {
        if (p >= out_.vertices.size()) missing(static_cast<int64_t>(p) + 1, faces_[f].line);
      }
      const std::string why = cutter.cut(out_.vertices, face, out_.triangles);
      if (!why.empty()) fail_at(faces_[f].line, why);
    }
  }

  TextLines lines_;
  SurfaceFile out_;
  std::vector<Face> faces_;
  std::vector<uint32_t> corners_;
  size_t triangles_ = 0;
  bool continued_ = false;
};

}  // namespace

bool is_obj_statement(std::string_view word) {
  return word.starts_with('#') || word == "v" || word == "f" || among(word, kPassedOver) ||
         among(word, kFreeForm);
}

SurfaceFile read_obj(std::string_view text) {
  return ObjReader(text).read();
}

}  // namespace truestep
