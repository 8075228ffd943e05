#include "engine/geometry/read/obj.h"

#include <algorithm>
#include <charconv>
#include <span>

#include "engine/geometry/read/text_lines.h"

namespace truestep {

namespace {

constexpr size_t kMostCorners = 10'000;  // of a face
constexpr std::string_view kPassedOver[] = {
    "vt",     "vn",     "vp",     "g",   "o",     "s",        "mg",       "l",          "p",        "usemtl",
    "mtllib", "usemap", "maplib", "lod", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj"};
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
    return std::move(out_);
  }

 private:
  /// The next word of the statement, on its next line after a backslash.
  std::string_view word() {
    for (;;) {
      const std::string_view w = lines_.peek();
      if (w != "\\") return w.starts_with('#') ? std::string_view{} : lines_.word();
      if (!lines_.next()) return {};
    }
  }
  void vertex() {
    if (out_.vertices.size() == kMostFileVertices) {
      lines_.fail("more than " + std::to_string(kMostFileVertices) + " vertices");
    }
    Vec3 p;
    p.x = lines_.coordinate("a coordinate");
    p.y = lines_.coordinate("a coordinate");
    p.z = lines_.coordinate("a coordinate");
    out_.vertices.push_back(p);
    double more = 0;
    // A weight, or the three components of a colour.
    for (std::string_view w = word(); !w.empty(); w = word()) {
      if (!read_double(w, more)) lines_.fail(quoted(w) + " after the coordinates of a vertex");
    }
  }
  uint32_t corner(std::string_view w) {
    const std::string_view head = w.substr(0, w.find('/'));
    int64_t index = 0;
    const auto [end, error] = std::from_chars(head.data(), head.data() + head.size(), index);
    if (error != std::errc() || end != head.data() + head.size())
      lines_.fail(quoted(w) + " is not a corner of a face: use an index, or index/texture/normal");
    const auto count = static_cast<int64_t>(out_.vertices.size());
    const int64_t at = index < 0 ? count + index : index - 1;
    if (index == 0 || at < 0 || at >= count) {
      lines_.fail("a face has vertex " + std::to_string(index) + ", and " + std::to_string(count) +
                  (count == 1 ? " vertex comes" : " vertices come") + " before it");
    }
    return static_cast<uint32_t>(at);
  }
  void face() {
    corners_.clear();
    for (std::string_view w = word(); !w.empty(); w = word()) {
      if (corners_.size() == kMostCorners)
        lines_.fail("a face has more than " + std::to_string(kMostCorners) + " corners");
      corners_.push_back(corner(w));
    }
    if (corners_.size() < 3)
      lines_.fail("a face has " + std::to_string(corners_.size()) + " corners: it needs at least three");
    if (out_.triangles.size() + corners_.size() - 2 > kMostFileTriangles) {
      lines_.fail("more than " + std::to_string(kMostFileTriangles) + " triangles");
    }
    for (size_t k = 1; k + 1 < corners_.size(); ++k)
      out_.triangles.push_back({corners_[0], corners_[k], corners_[k + 1]});
  }

  TextLines lines_;
  SurfaceFile out_;
  std::vector<uint32_t> corners_;
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
