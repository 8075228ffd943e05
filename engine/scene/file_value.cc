#include "engine/scene/file_value.h"

#include <algorithm>
#include <boost/json.hpp>

#include "engine/base/text/encoding.h"
#include "engine/base/text/utf8.h"
#include "engine/geometry/read/msh.h"
#include "engine/geometry/read/obj.h"
#include "engine/geometry/read/ply.h"
#include "engine/geometry/read/stl.h"
#include "engine/geometry/read/text_lines.h"
#include "engine/scene/json/json.h"

namespace truestep {

namespace json = boost::json;

namespace {

enum class Format : uint8_t { json, obj, stl, ply, msh, bvh, glb, unknown };

// Recognised by how it begins; binary STL by its length.
Format format_of(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return Format::glb;
  if (is_binary_stl(bytes)) return Format::stl;
  TextLines lines(bytes);
  const std::string_view word = lines.next_word();
  if (word == "ply") return Format::ply;
  if (word == "$MeshFormat" || word == "$Comments" || word == "$NOD") return Format::msh;
  if (same_word(word, "solid")) return Format::stl;
  if (same_word(word, "HIERARCHY")) return Format::bvh;
  if (is_obj_statement(word)) return Format::obj;
  const bool value = word.starts_with("true") || word.starts_with("false") || word.starts_with("null");
  constexpr std::string_view kBegins = "{[\"-0123456789";
  if (value || (!word.empty() && kBegins.find(word.front()) != kBegins.npos)) return Format::json;
  return Format::unknown;
}

json::array vertices_value(const std::vector<Vec3>& vertices, double scale) {
  json::array out;
  out.reserve(vertices.size());
  for (const Vec3& p : vertices) out.push_back(json::array{p.x * scale, p.y * scale, p.z * scale});
  return out;
}

json::array triangles_value(const SurfaceFile& surface) {
  json::array out;
  out.reserve(3 * surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) {
    if (a == b || b == c || c == a) continue;
    for (const uint32_t p : {a, b, c}) out.push_back(static_cast<int64_t>(p));
  }
  return out;
}

json::object cells_value(const CellFile& mesh, double scale) {
  json::array cells, sets;
  cells.reserve(mesh.cells.size());
  for (const uint32_t p : mesh.cells) cells.push_back(static_cast<int64_t>(p));
  for (const CellFile::Group& g : mesh.groups) {
    json::array points;
    points.reserve(g.vertices.size());
    for (const uint32_t p : g.vertices) points.push_back(static_cast<int64_t>(p));
    sets.push_back(json::object{{"name", g.name}, {"points", std::move(points)}});
  }
  return {{"vertices", vertices_value(mesh.vertices, scale)},
          {"cells", std::move(cells)},
          {"form", name_of(mesh.form)},
          {"sets", std::move(sets)}};
}

SurfaceFile surface_file(Format format, std::string_view bytes) {
  switch (format) {
    case Format::obj:
      return read_obj(bytes);
    case Format::stl:
      return read_stl(bytes);
    case Format::ply:
      return read_ply(bytes);
    case Format::msh:
      return surface_of(read_msh(bytes));
    case Format::json:
    case Format::bvh:
    case Format::glb:
    case Format::unknown:
      break;
  }
  throw FileFault("the file is not a mesh: use OBJ, STL, PLY or MSH");
}

json::value mesh_value(Format format, std::string_view bytes, FileUse use, double scale) {
  if (use == FileUse::cells && format != Format::msh)
    throw FileFault("only MSH files have elements: fill the surface of this one");
  if (format == Format::msh && (use == FileUse::automatic || use == FileUse::cells)) {
    const CellFile mesh = read_msh(bytes);
    for (const CellFile::Group& g : mesh.groups) {
      if (!valid_utf8(g.name)) throw FileFault("the name of a group is not valid UTF-8");
    }
    return cells_value(mesh, scale);
  }
  const SurfaceFile surface = surface_file(format, bytes);
  if (use == FileUse::vertices) return vertices_value(surface.vertices, scale);
  json::array triangles = triangles_value(surface);
  if (triangles.empty()) throw FileFault("the file has vertices but no triangles");
  if (use == FileUse::triangles) return triangles;
  return json::object{{"vertices", vertices_value(surface.vertices, scale)},
                      {"triangles", std::move(triangles)}};
}

json::array lines_value(std::string_view text) {
  json::array out;
  TextLines lines(text);
  while (lines.next()) out.push_back(json::string(lines.whole()));
  return out;
}

/// The value of members `gltf` in scenes: base64 of a .glb, the text of a .gltf.
json::array gltf_value(Format format, std::string_view bytes) {
  constexpr size_t kPiece = 4000;
  std::string text(bytes);
  if (format == Format::glb) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    text.clear();
    for (size_t i = 0; i < bytes.size(); i += 3) {
      uint32_t three = 0;
      for (size_t k = 0; k < 3; ++k) {
        three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
      }
      for (size_t k = 0; k < 4; ++k) {
        text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63];
      }
    }
  } else if (format != Format::json) {
    throw FileFault("the file is not glTF: it begins with neither glTF nor {");
  } else if (!valid_utf8(bytes)) {
    throw FileFault("byte " + std::to_string(find_invalid_utf8(bytes) + 1) +
                    ": a .gltf file must be valid UTF-8");
  }
  json::array out;
  for (size_t at = 0; at < text.size();) {
    size_t end = std::min(at + kPiece, text.size());
    // Not within a character of several bytes.
    while (end < text.size() && (static_cast<uint8_t>(text[end]) & 0xC0) == 0x80) --end;
    out.push_back(json::string(std::string_view(text).substr(at, end - at)));
    at = end;
  }
  return out;
}

}  // namespace

bool is_mesh_file(std::string_view bytes) {
  if (const auto converted = utf8_of_utf16(bytes)) return is_mesh_file(*converted);
  const Format format = format_of(bytes);
  return format == Format::obj || format == Format::stl || format == Format::ply || format == Format::msh;
}

json::value file_value(std::string_view bytes, FileUse use, double scale) {
  if (const auto converted = utf8_of_utf16(bytes)) return file_value(*converted, use, scale);
  bytes = without_byte_order_mark(bytes);
  const Format format = format_of(bytes);
  const bool lines = use == FileUse::lines || (use == FileUse::automatic && format == Format::bvh);
  if (lines || use == FileUse::text) {
    if (!valid_utf8(bytes)) {
      throw FileFault("byte " + std::to_string(find_invalid_utf8(bytes) + 1) +
                      ": a text must be valid UTF-8");
    }
    return lines ? json::value(lines_value(bytes)) : json::value(json::string(bytes));
  }
  if (use == FileUse::gltf || (use == FileUse::automatic && format == Format::glb))
    return gltf_value(format, bytes);
  if (use == FileUse::automatic && format == Format::json) return parse_json(bytes);
  if (use == FileUse::automatic && format == Format::unknown) {
    throw FileFault(
        "the file is none of JSON, OBJ, STL, PLY, MSH, BVH and .glb: for a text give \"as\": \"text\" or "
        "\"lines\"");
  }
  try {
    return mesh_value(format, bytes, use, scale);
  } catch (const MeshFault& fault) {
    throw FileFault(fault.what());
  }
}

}  // namespace truestep
