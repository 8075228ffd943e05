// Surfaces in the Wavefront OBJ format: lines `v x y z` with vertices and `f a b c ...` with faces of three
// corners or more, each an index from 1, or from the end where it is negative, with those of texture and
// normal behind slashes, which do not count here. Faces of more corners are cut into a fan from their first
// one, which is right where they are convex. Groups, materials, lines and points are passed over;
// free-form curves and surfaces are not read.
#pragma once
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

/// Throws MeshFault with a line. Without faces: points alone, as targets of blend shapes may be.
SurfaceFile read_obj(std::string_view text);

/// True for the first word of a line of such a file.
bool is_obj_statement(std::string_view word);

}  // namespace truestep
