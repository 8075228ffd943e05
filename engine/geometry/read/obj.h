// Surfaces in the Wavefront OBJ format: lines `v x y z` with vertices and `f a b c ...` with faces of three
// corners or more, each an index from 1, or from the end so far if negative, with those of texture and normal
// after slashes, which are ignored. A line may continue on the next one after a backslash, and a face may
// come before its vertices. Faces of more than three corners are cut as polygon.h says. Groups, materials,
// lines, points and tags of subdivision are skipped; free-form curves and surfaces are not read.
#pragma once
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

/// Throws MeshFault with a line. A file without faces is just points, as targets of blend shapes may be.
SurfaceFile read_obj(std::string_view text);

/// True for the first word of a line in such a file.
bool is_obj_statement(std::string_view word);

}  // namespace truestep
