// Base and targets of blended shapes out of glTF files: a mesh with its morph targets as the base with its
// targets, and meshes of further files as further targets, vertex by vertex in the base's order. Coordinates
// are those of the mesh; nodes that place it are not looked at. (OBJ and PLY come as lists of vertices and
// triangles, scene/file_value.h.)
#pragma once
#include "engine/systems/blend_shapes/blend_shapes.h"

namespace truestep::blend_shapes {

/// The same without files. Error "scene_invalid" with a pointer where a file cannot be read, or holds no such
/// mesh or target, or another number of vertices than the base.
BlendShapesDef with_files(const BlendShapesDef& def);

}  // namespace truestep::blend_shapes
