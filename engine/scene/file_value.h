// Files as values in a scene. A surface (OBJ, STL, PLY; engine/geometry/read) becomes {"vertices",
// "triangles"}, a mesh of elements (MSH) {"vertices", "cells", "form", "sets"}, motion (BVH) a list of its
// lines, JSON its own value: the forms that members of scenes expect.
#pragma once
#include <boost/json/value.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace truestep {

/// How a file is used: `automatic` is the above; `surface` also takes the surface of a mesh of elements;
/// `vertices` and `triangles` give just these lists of a surface; `text` and `lines` apply to any text.
enum class FileUse : uint8_t { automatic, surface, cells, vertices, triangles, text, lines };
/// Their names in scenes, in that order; automatic is "".
inline constexpr std::string_view kFileUses[] = {"",          "surface", "cells", "vertices",
                                                 "triangles", "text",    "lines"};

/// Why a file is not what it should be, with its line or byte.
struct FileFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Coordinates are multiplied by `scale`. Degenerate triangles, with two corners at one vertex, are dropped.
/// Throws FileFault, or Error "bad_json" for a file that looks like JSON and is not.
boost::json::value file_value(std::string_view bytes, FileUse use, double scale);

/// True for OBJ, STL, PLY and MSH, by how the file begins.
bool is_mesh_file(std::string_view bytes);

}  // namespace truestep
