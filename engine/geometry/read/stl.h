// Surfaces in the STL format, text (`solid ... facet normal ... outer loop vertex x y z ...`) and binary (80
// bytes of anything, a count, then 50 bytes a triangle: normal, three corners, two spare bytes; little
// endian). Corners at the very same place are one vertex. Normals do not count: triangles run
// anticlockwise as seen from outside.
#pragma once
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

/// Binary where the length is that which the count says, text where it begins with "solid". Throws MeshFault
/// with a line or a byte.
SurfaceFile read_stl(std::string_view bytes);

/// True where the length is that of a binary file.
bool is_binary_stl(std::string_view bytes);

}  // namespace truestep
