// Surfaces in the STL format, text (`solid ... facet normal ... outer loop vertex x y z ...`) and binary (80
// arbitrary bytes, a count, then 50 bytes per triangle: normal, three corners, two spare bytes; little
// endian). Corners at exactly the same position are one vertex. Normals are ignored: triangles run
// anticlockwise as seen from outside.
#pragma once
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

/// Text if it starts with "solid" and has a facet or an end; binary otherwise, or if the length matches the
/// count; bytes after the last triangle are ignored. Throws MeshFault with a line or a byte.
SurfaceFile read_stl(std::string_view bytes);

/// True if the length is that of a binary file, but for bytes behind it that are no triangle.
bool is_binary_stl(std::string_view bytes);

}  // namespace truestep
