// Base and targets of blend shapes from glTF files: a mesh with its morph targets as the base with its
// targets, and meshes of further files as additional targets, vertex by vertex in the base's order.
// Coordinates are those of the mesh; the transforms of the nodes that place it are ignored. (OBJ and PLY
// files are read as lists of vertices and triangles, scene/file_value.h.)
#pragma once
#include "engine/systems/blend_shapes/blend_shapes.h"

namespace truestep::blend_shapes {

/// The def with the contents of its files in place of their names. Error "scene_invalid" with a pointer if a
/// file cannot be read, lacks the mesh or target, or has another number of vertices than the base.
BlendShapesDef with_files(const BlendShapesDef& def);

}  // namespace truestep::blend_shapes
