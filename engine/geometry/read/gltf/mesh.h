// A mesh of a glTF document: its triangles, weights of skins and morph targets.
#pragma once
#include "engine/geometry/read/gltf/buffers.h"

namespace truestep::gltf {

/// All primitives of triangles, their strips and fans as one; points and lines are passed over.
GltfMesh read_mesh(const Value& mesh, const Buffers& buffers);

}  // namespace truestep::gltf
