// The header of a PLY file: names, counts and properties of its elements.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/geometry/read/text_lines.h"

namespace truestep {

enum class PlyFormat : uint8_t { ascii, binary_little_endian, binary_big_endian };
enum class PlyType : uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count;  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;
  /// Minimum bytes per element: a list may be empty.
  size_t least_size(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
};

/// Leaves `lines` at the line end_header. Throws MeshFault, also for a count that the rest of the text cannot
/// hold.
PlyHeader read_ply_header(TextLines& lines);

}  // namespace truestep
