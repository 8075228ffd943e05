// Files as values in a scene. A surface (OBJ, STL, PLY; engine/geometry/read) becomes {"vertices",
// "triangles"}, a mesh of elements (MSH) {"vertices", "cells", "form", "sets"}, motion (BVH) a list of its
// lines, glTF (a .glb by itself, a .gltf with "as") pieces of its text or base64, and JSON its own value: the
// forms that the corresponding members of scenes accept. Texts may begin with a byte order mark, and be
// UTF-16 with one.
#pragma once
#include <boost/json/value.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace truestep {

/// The wanted form of a file: `automatic` is the above; `surface` also of a mesh of elements; `vertices` and
/// `triangles` of a surface alone, as lists; `text` and `lines` of any text; `gltf` of glTF, whose text may
/// be split anywhere.
enum class FileUse : uint8_t { automatic, surface, cells, vertices, triangles, text, lines, gltf };
/// By their names in scenes, in that order; automatic is "".
inline constexpr std::string_view kFileUses[] = {"",          "surface", "cells", "vertices",
                                                 "triangles", "text",    "lines", "gltf"};

/// Why a file cannot be used, with its line or byte.
struct FileFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Coordinates are multiplied by `scale`. Degenerate triangles, with two corners at one vertex, are dropped.
/// Throws FileFault, or Error "bad_json" for a file that looks like JSON and is not.
boost::json::value file_value(std::string_view bytes, FileUse use, double scale);

/// True for OBJ, STL, PLY and MSH, by how the file begins.
bool is_mesh_file(std::string_view bytes);

}  // namespace truestep
