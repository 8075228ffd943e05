// Surfaces in the PLY format (Turk 1994), version 1.0: a header that declares elements and their properties,
// then their values as text or binary of either byte order. Element `vertex` has x, y and z; element `face`,
// which may be absent, has a list vertex_indices (or vertex_index), faces of more than three corners are cut
// as polygon.h says; lists of an element `tristrips` are strips of triangles, which -1 ends. All other
// elements and properties are skipped.
#pragma once
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

/// Throws MeshFault with a line, or with a byte when the values are binary.
SurfaceFile read_ply(std::string_view bytes);

}  // namespace truestep
