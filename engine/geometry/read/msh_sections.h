// The contents of an MSH file's sections, in either version.
#pragma once
#include <map>
#include <utility>

#include "engine/geometry/read/text_lines.h"

namespace truestep {

struct MshElement {
  uint32_t first;   ///< of its corners in `corners`
  uint8_t type;     ///< Gmsh's number
  uint32_t entity;  ///< of `entities`
};

struct MshSections {
  /// Dimension and number of a physical group.
  using Group = std::pair<int, int64_t>;
  std::map<Group, std::string> names;
  std::vector<Vec3> nodes;
  std::vector<std::pair<int64_t, uint32_t>> tags;  ///< of nodes, ascending, with their indices in `nodes`
  std::vector<MshElement> elements;
  std::vector<uint32_t> corners;             ///< indices into `nodes`
  std::vector<std::vector<Group>> entities;  ///< groups that elements belong to
};

/// For Gmsh's types; 0 for types that are not read.
size_t msh_corners(int64_t type);
int msh_dimension(uint8_t type);

/// Throws MeshFault with a line.
MshSections read_msh_sections(std::string_view text);

}  // namespace truestep
